// A text as presentation MathML.
#include "core/text/functions.hpp"

namespace least::text {
namespace {

using TokenKind = Token::Kind;

const char* shown_sign(TokenKind kind) {
  switch (kind) {
    case TokenKind::add:
      return "<mo>+</mo>";
    case TokenKind::subtract:
      return "<mo>−</mo>";
    case TokenKind::less:
      return "<mo>&lt;</mo>";
    case TokenKind::less_equal:
      return "<mo>≤</mo>";
    case TokenKind::greater:
      return "<mo>&gt;</mo>";
    case TokenKind::greater_equal:
      return "<mo>≥</mo>";
    case TokenKind::conjunction:
      return "<mo>∧</mo>";
    case TokenKind::disjunction:
      return "<mo>∨</mo>";
    default:
      return "<mo>⁢</mo>";
  }
}

}  // namespace

std::string Expression::mathml(const std::function<std::string(std::string_view)>& shown) const {
  struct Piece {
    std::string markup;
    int binds;
    bool open = false;  // ends in a sum or a product, which extends as far to the right as possible
  };
  const auto row = [](const std::string& a) { return "<mrow>" + a + "</mrow>"; };
  const auto bracketed = [](const Piece& piece, bool wanted) {
    return wanted ? "<mrow><mo>(</mo>" + piece.markup + "<mo>)</mo></mrow>" : piece.markup;
  };
  std::vector<Piece> stack;
  for (const Token& token : tokens_) {
    if (token.kind == TokenKind::number) {
      stack.push_back({"<mn>" + std::string(token.word) + "</mn>", 9});
    } else if (token.kind == TokenKind::name) {
      std::string name = token.word == "pi" ? "<mi>π</mi>" : shown(token.word);
      const bool open = name.starts_with(series_markup);
      stack.push_back({std::move(name), open ? 2 : 9, open});
    } else if (token.kind == TokenKind::minus) {
      Piece& x = stack.back();
      x = {row("<mo>−</mo>" + bracketed(x, x.binds < 3 && !x.open)), 3, x.open};
    } else if (token.kind == TokenKind::negation) {
      Piece& x = stack.back();
      x = {row("<mo>¬</mo>" + bracketed(x, x.binds < 9)), 8};
    } else if (token.kind == TokenKind::call) {
      std::vector<std::string> parts;
      for (std::size_t i = stack.size() - token.arguments; i < stack.size(); ++i) parts.push_back(stack[i].markup);
      stack.resize(stack.size() - token.arguments);
      if (token.word == "sqrt") {
        stack.push_back({"<msqrt>" + parts[0] + "</msqrt>", 9});
      } else if (token.word == "abs") {
        stack.push_back({row("<mo>|</mo>" + parts[0] + "<mo>|</mo>"), 9});
      } else if (token.word == "if") {
        stack.push_back(
            {row("<mo>{</mo><mtable><mtr><mtd>" + parts[1] + "</mtd><mtd>" + parts[0] + "</mtd></mtr><mtr><mtd>" +
                 parts[2] + "</mtd><mtd><mtext>else</mtext></mtd></mtr></mtable>"),
             9});
      } else {
        std::string all = parts[0];
        for (std::size_t i = 1; i < parts.size(); ++i) all += "<mo>,</mo>" + parts[i];
        stack.push_back(
            {row("<mi>" + std::string(token.word) + "</mi><mo>⁡</mo><mrow><mo>(</mo>" + all + "<mo>)</mo></mrow>"),
             9});
      }
    } else {
      const Piece right = std::move(stack.back());
      stack.pop_back();
      Piece& left = stack.back();
      const int mine = precedence(token.kind).binds;
      if (token.kind == TokenKind::divide) {
        left = {"<mfrac>" + row(left.markup) + row(right.markup) + "</mfrac>", 9};
      } else if (token.kind == TokenKind::power) {
        left = {"<msup>" + row(bracketed(left, left.binds < 9 || left.markup.starts_with("<mfrac"))) +
                    row(right.markup) + "</msup>",
                8};
      } else {
        const char* sign = shown_sign(token.kind);
        const bool wrap = right.binds < mine || (token.kind == TokenKind::subtract && right.binds == mine) ||
                          (token.kind != TokenKind::power && right.binds == 3);
        const bool ends_before = left.open && token.kind == TokenKind::multiply;
        left = {row(bracketed(left, left.binds < mine || ends_before) + sign + bracketed(right, wrap)), mine,
                right.open && !wrap};
      }
    }
    if (stack.back().markup.size() > 50'000) return "<mi>…</mi>";
  }
  return stack.back().markup;
}

}  // namespace least::text
