#include "core/text/expression.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <memory>
#include <numbers>

#include "core/text/characters.hpp"

namespace least::text {
namespace {

using TokenKind = Token::Kind;

constexpr std::array<std::string_view, 14> functions{"sin",  "cos",  "tan", "asin", "acos", "atan", "sinh",
                                                     "cosh", "tanh", "exp", "log",  "sqrt", "abs",  "ln"};
std::string listed_functions() {
  std::string all;
  for (const auto function : functions) all += (all.empty() ? "" : ", ") + std::string(function);
  return all;
}
constexpr std::uint8_t absolute = 12;

struct Precedence {
  int binds;
  bool right = false;
};
constexpr Precedence precedence(TokenKind kind) {
  switch (kind) {
    case TokenKind::add:
    case TokenKind::subtract:
      return {1};
    case TokenKind::multiply:
    case TokenKind::divide:
      return {2};
    case TokenKind::minus:
      return {3, true};
    case TokenKind::power:
      return {4, true};
    default:
      return {0};
  }
}

class Parser {
 public:
  Parser(std::string_view text, std::size_t most) : text_(text), most_(most) {}

  std::optional<Fault> read(std::vector<Token>& postfix) {
    if (text_.size() > most_)
      return Fault{most_, "is longer than a scene may be", std::to_string(most_) + " characters"};
    while (skip_space(), at_ < text_.size())
      if (auto fault = expects_operand_ ? operand(postfix) : operation(postfix)) return fault;
    if (expects_operand_)
      return Fault{text_.size(),
                   postfix.empty() && stack_.empty() ? "is empty" : "ends where a number, a name or ( is due"};
    while (!stack_.empty()) {
      if (stack_.back().bracket) return Fault{stack_.back().token.position, "( is never closed", ")"};
      postfix.push_back(stack_.back().token);
      stack_.pop_back();
    }
    return std::nullopt;
  }

 private:
  struct Pending {
    Token token;
    bool bracket = false;
  };

  /// What waits: of each bracket itself, a function, and what stands before it.
  static constexpr std::size_t deepest = 5 * most_nesting;

  void skip_space() {
    while (at_ < text_.size() && is_space(text_[at_])) ++at_;
  }
  std::uint32_t here() const { return static_cast<std::uint32_t>(at_); }
  Fault stranger() const {
    const char c = text_[at_];
    if (static_cast<unsigned char>(c) >= 0x80)
      return {at_, "is no ASCII character", "letters a–z, digits, + - * / ^ ( )"};
    return {at_, std::string("'") + c + "' means nothing here", "letters a–z, digits, + - * / ^ ( )"};
  }

  std::optional<Fault> operand(std::vector<Token>& postfix) {
    const char c = text_[at_];
    if (c == '(') return open();
    if (c == '-' || c == '+') {
      if (c == '-' && stack_.size() > deepest) return too_deep();
      if (c == '-') stack_.push_back({{TokenKind::minus, 0, here(), 0, {}}});
      ++at_;
      return std::nullopt;
    }
    if (is_digit(c) || c == '.') return number(postfix);
    if (is_letter(c)) return name(postfix);
    if (c == ')' || c == '*' || c == '/' || c == '^') return Fault{at_, "a number, a name or ( is due here"};
    return stranger();
  }

  /// Signs and powers that wait for what follows nest as brackets do.
  Fault too_deep() const { return {at_, "is nested too deep", std::to_string(most_nesting) + " at most"}; }

  std::optional<Fault> open() {
    if (++nesting_ > most_nesting) return too_deep();
    stack_.push_back({{TokenKind::number, 0, here(), 0, {}}, true});
    ++at_;
    return std::nullopt;
  }

  std::optional<Fault> number(std::vector<Token>& postfix) {
    double value = 0;
    const char* from = text_.data() + at_;
    const auto [end, error] = std::from_chars(from, text_.data() + text_.size(), value);
    if (error == std::errc::invalid_argument) return Fault{at_, "is no number"};
    if (error == std::errc::result_out_of_range) return Fault{at_, "is a number that no double holds"};
    const auto length = static_cast<std::size_t>(end - from);
    postfix.push_back({TokenKind::number, 0, here(), value, text_.substr(at_, length)});
    at_ += length;
    expects_operand_ = false;
    return std::nullopt;
  }

  std::optional<Fault> name(std::vector<Token>& postfix) {
    const std::size_t from = at_;
    at_ = end_of_word(text_, at_, text_.size());
    skip_index();
    const std::string_view word = text_.substr(from, at_ - from);
    const auto found = std::find(functions.begin(), functions.end(), word);
    if (found == functions.end()) {
      skip_space();
      if (at_ < text_.size() && text_[at_] == '(')
        return Fault{from, std::string(word) + " is no function, and a product needs its sign", listed_functions(),
                     std::string(word)};
      postfix.push_back({TokenKind::name, 0, static_cast<std::uint32_t>(from), 0, word});
      expects_operand_ = false;
      return std::nullopt;
    }
    skip_space();
    if (at_ == text_.size() || text_[at_] != '(')
      return Fault{from, std::string(word) + " is a function: its argument stands in brackets",
                   std::string(word) + "(…)"};
    stack_.push_back({{TokenKind::call, static_cast<std::uint8_t>(found - functions.begin()),
                       static_cast<std::uint32_t>(from), 0, word}});
    return open();
  }

  /// Past `[3]`, if that stands here.
  void skip_index() {
    std::size_t to = at_;
    if (to == text_.size() || text_[to++] != '[') return;
    const std::size_t digits = to;
    while (to < text_.size() && is_digit(text_[to])) ++to;
    if (to > digits && to < text_.size() && text_[to] == ']') at_ = to + 1;
  }

  std::optional<Fault> operation(std::vector<Token>& postfix) {
    const char c = text_[at_];
    if (c == ')') return close(postfix);
    if (c == '(' || c == '.' || is_digit(c) || is_letter(c))
      return Fault{at_, "a product needs its sign", "* before this"};
    constexpr std::string_view signs = "+-*/^";
    constexpr TokenKind kinds[] = {TokenKind::add, TokenKind::subtract, TokenKind::multiply, TokenKind::divide,
                                   TokenKind::power};
    const std::size_t which = signs.find(c);
    if (which == std::string_view::npos) return stranger();
    const bool doubled = c == '*' && at_ + 1 < text_.size() && text_[at_ + 1] == '*';
    const TokenKind kind = doubled ? TokenKind::power : kinds[which];
    const Precedence mine = precedence(kind);
    while (!stack_.empty() && !stack_.back().bracket) {
      const Precedence top = precedence(stack_.back().token.kind);
      if (!(top.binds > mine.binds || (top.binds == mine.binds && !mine.right))) break;
      postfix.push_back(stack_.back().token);
      stack_.pop_back();
    }
    if (stack_.size() > deepest) return too_deep();
    stack_.push_back({{kind, 0, here(), 0, {}}});
    at_ += doubled ? 2 : 1;
    expects_operand_ = true;
    return std::nullopt;
  }

  std::optional<Fault> close(std::vector<Token>& postfix) {
    while (!stack_.empty() && !stack_.back().bracket) {
      postfix.push_back(stack_.back().token);
      stack_.pop_back();
    }
    if (stack_.empty()) return Fault{at_, ") was never opened"};
    stack_.pop_back();
    --nesting_;
    if (!stack_.empty() && stack_.back().token.kind == TokenKind::call && !stack_.back().bracket) {
      postfix.push_back(stack_.back().token);
      stack_.pop_back();
    }
    ++at_;
    return std::nullopt;
  }

  std::string_view text_;
  std::size_t most_, at_ = 0, nesting_ = 0;
  bool expects_operand_ = true;
  std::vector<Pending> stack_;
};

Symbol call(std::uint8_t function, const Symbol& x) {
  using Function = Symbol (*)(const Symbol&);
  constexpr Function by_name[] = {
      [](const Symbol& a) { return sin(a); },  [](const Symbol& a) { return cos(a); },
      [](const Symbol& a) { return tan(a); },  [](const Symbol& a) { return asin(a); },
      [](const Symbol& a) { return acos(a); }, [](const Symbol& a) { return atan(a); },
      [](const Symbol& a) { return sinh(a); }, [](const Symbol& a) { return cosh(a); },
      [](const Symbol& a) { return tanh(a); }, [](const Symbol& a) { return exp(a); },
      [](const Symbol& a) { return log(a); },  [](const Symbol& a) { return sqrt(a); },
      [](const Symbol& a) { return abs(a); },  [](const Symbol& a) { return log(a); },
  };
  static_assert(std::size(by_name) == functions.size());
  return by_name[function](x);
}

Symbol operate(TokenKind kind, const Symbol& a, const Symbol& b) {
  switch (kind) {
    case TokenKind::add:
      return a + b;
    case TokenKind::subtract:
      return a - b;
    case TokenKind::multiply:
      return a * b;
    case TokenKind::divide:
      return a / b;
    default:
      return raise(a, b);
  }
}

std::string listed(std::span<const Word> words) {
  std::string names;
  for (const Word& word : words)
    if (word.refusal.empty()) names.append(names.empty() ? "" : ", ").append(word.name);
  return names + (names.empty() ? "pi" : ", pi");
}

// Whether constants are numbers, those too that were written from a place on: `x/0` is a product with 1/0.
bool is_finite(const Symbol& made, const tape::Tape& tape, tape::Index from) {
  for (; from < tape.size(); ++from)
    if (tape[from].op == tape::Op::constant && !std::isfinite(tape[from].value)) return false;
  return !made.is_constant() || std::isfinite(made.constant());
}

}  // namespace

std::span<const std::string_view> function_names() { return functions; }

bool is_name(std::string_view word) {
  return !word.empty() && is_letter(word.front()) && std::all_of(word.begin(), word.end(), is_part);
}

std::variant<Expression, Fault> Expression::parse(std::string text, std::size_t most) {
  Expression read;
  read.text_ = std::make_shared<const std::string>(std::move(text));
  if (auto fault = Parser(*read.text_, most).read(read.tokens_)) return std::move(*fault);
  return read;
}

std::optional<double> constant_of(std::string_view text) {
  const auto parsed = Expression::parse(std::string(text), most_characters);
  const auto* expression = std::get_if<Expression>(&parsed);
  if (!expression) return std::nullopt;
  tape::Tape tape;
  const auto recorded = expression->record(tape, {}, true);
  const auto* symbol = std::get_if<Symbol>(&recorded);
  return symbol && symbol->is_constant() ? std::optional(symbol->constant()) : std::nullopt;
}

std::variant<Symbol, Fault> Expression::record(tape::Tape& tape, std::span<const Word> words, bool allows_abs) const {
  std::vector<Symbol> stack;
  for (const Token& token : tokens_) {
    const tape::Index from = tape.size();
    Symbol made;
    if (token.kind == TokenKind::number) {
      made = token.value;
    } else if (token.kind == TokenKind::name) {
      const auto known = std::find_if(words.begin(), words.end(), [&](const Word& w) { return w.name == token.word; });
      if (known != words.end() && known->refusal.empty()) {
        made = known->meaning;
      } else if (known == words.end() && token.word == "pi") {
        made = std::numbers::pi;
      } else if (known != words.end()) {
        return Fault{token.position, std::string(token.word) + " " + std::string(known->refusal), listed(words)};
      } else {
        return Fault{token.position, "nobody knows the name " + std::string(token.word), listed(words),
                     std::string(token.word)};
      }
    } else if (token.kind == TokenKind::minus) {
      made = -stack.back();
      stack.pop_back();
    } else if (token.kind == TokenKind::call) {
      if (token.function == absolute && !allows_abs)
        return Fault{token.position, "abs has no derivative where its argument is zero: not in a scene's mechanics",
                     "sqrt(x^2 + a^2)"};
      made = call(token.function, stack.back());
      stack.pop_back();
    } else {
      const Symbol right = stack.back();
      stack.pop_back();
      made = operate(token.kind, stack.back(), right);
      stack.pop_back();
    }
    if (!is_finite(made, tape, from)) return Fault{token.position, "is no finite number here"};
    if (tape.size() > static_cast<tape::Index>(most_operations))
      return Fault{token.position, "takes too many operations", std::to_string(most_operations) + " a scene"};
    stack.push_back(made);
  }
  return stack.back();
}

std::string Expression::mathml(const std::function<std::string(std::string_view)>& shown) const {
  struct Piece {
    std::string markup;
    int binds;
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
      stack.push_back({token.word == "pi" ? "<mi>π</mi>" : shown(token.word), 9});
    } else if (token.kind == TokenKind::minus) {
      Piece& x = stack.back();
      x = {row("<mo>−</mo>" + bracketed(x, x.binds < 3)), 3};
    } else if (token.kind == TokenKind::call) {
      Piece& x = stack.back();
      if (token.word == "sqrt") {
        x = {"<msqrt>" + x.markup + "</msqrt>", 9};
      } else if (token.word == "abs") {
        x = {row("<mo>|</mo>" + x.markup + "<mo>|</mo>"), 9};
      } else {
        x = {row("<mi>" + std::string(token.word) + "</mi><mo>⁡</mo><mrow><mo>(</mo>" + x.markup +
                 "<mo>)</mo></mrow>"),
             9};
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
        const char* sign = token.kind == TokenKind::add        ? "<mo>+</mo>"
                           : token.kind == TokenKind::subtract ? "<mo>−</mo>"
                                                               : "<mo>⁢</mo>";
        const bool wrap = right.binds < mine || (token.kind == TokenKind::subtract && right.binds == mine) ||
                          (token.kind != TokenKind::power && right.binds == 3);
        left = {row(bracketed(left, left.binds < mine) + sign + bracketed(right, wrap)), mine};
      }
    }
    if (stack.back().markup.size() > 50'000) return "<mi>…</mi>";
  }
  return stack.back().markup;
}

}  // namespace least::text
