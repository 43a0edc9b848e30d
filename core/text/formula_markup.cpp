#include "core/text/formula_markup.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "core/text/brackets.hpp"
#include "core/text/characters.hpp"
#include "core/text/expansion.hpp"
#include "core/text/functions.hpp"
#include "core/text/written_out.hpp"

namespace least::text {
namespace {

std::string row(const std::string& inside) { return "<mrow>" + inside + "</mrow>"; }
std::string with_index(const std::string& of, const std::string& index) {
  return "<msub>" + of + row(index) + "</msub>";
}

/// markup_of_index marks up an index, a bound or a condition on indices character by character: `i+1`, `mod(i,n)`, `i
/// != j`.
std::string markup_of_index(std::string_view text) {
  constexpr std::pair<std::string_view, std::string_view> signs[] = {
      {"==", "="}, {"!=", "≠"}, {"<=", "≤"}, {">=", "≥"}, {"<", "&lt;"}, {">", "&gt;"}, {"-", "−"}, {"*", "⁢"}};
  constexpr std::pair<std::string_view, std::string_view> words[] = {{"and", "∧"}, {"or", "∨"}, {"not", "¬"}};
  std::string made;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t word = end_of_word(text, at, text.size());
    if (word > at) {
      const std::string_view name = text.substr(at, word - at);
      const auto* const known = std::ranges::find(words, name, [](const auto& one) { return one.first; });
      if (known != std::end(words))
        made.append("<mo>").append(known->second).append("</mo>");
      else
        made.append(is_digit(name[0]) ? "<mn>" : "<mi>").append(name).append(is_digit(name[0]) ? "</mn>" : "</mi>");
      at = word;
      continue;
    }
    if (is_space(text[at])) {
      ++at;
      continue;
    }
    const auto* const sign =
        std::ranges::find_if(signs, [&](const auto& one) { return text.substr(at).starts_with(one.first); });
    const bool known = sign != std::end(signs);
    made.append("<mo>").append(known ? sign->second : text.substr(at, 1)).append("</mo>");
    at += known ? sign->first.size() : 1;
  }
  return made;
}

/// Markup marks up the texts of one scene. Constructs that an Expression cannot parse - elements by an index,
/// definitions with indices, sums and products, conditions on indices - are replaced by stand-in names, whose markup
/// shows what was typed.
class Markup {
 public:
  explicit Markup(const Vocabulary* vocabulary) : vocabulary_(vocabulary) {}

  std::string of(std::string_view text) { return made(text).text; }

 private:
  struct Made {
    std::string text;
    bool adds = false;  ///< a sum or a difference of terms
  };
  /// Longer than any name that can be typed.
  static constexpr std::string_view stand_in = "what_was_typed_with_indices_and_is_no_expression_";

  Made made(std::string_view text) {
    if (++depth_ > most_nesting) return {"<mi>…</mi>"};
    const std::string plain = with_stand_ins(text);
    --depth_;
    const auto parsed = Expression::parse(plain);
    const auto* const expression = std::get_if<Expression>(&parsed);
    if (expression == nullptr) return {"<mi>…</mi>"};
    const auto last = expression->tokens().back().kind;
    return {expression->mathml([&](std::string_view name) { return shown(name); }),
            last == Token::Kind::add || last == Token::Kind::subtract};
  }

  std::string shown(std::string_view name) const {
    if (name.starts_with(stand_in)) return pieces_[std::stoul(std::string(name.substr(stand_in.size())))];
    const auto element = element_of(name);
    if (!element) return "<mi>" + std::string(name) + "</mi>";
    return with_index("<mi>" + std::string(element->first) + "</mi>",
                      "<mn>" + std::to_string(element->second) + "</mn>");
  }
  std::string keep(std::string piece) {
    pieces_.push_back(std::move(piece));
    return std::string(stand_in) + std::to_string(pieces_.size() - 1);
  }

  std::string with_stand_ins(std::string_view text) {
    std::string plain;
    const std::size_t to = text.size();
    for (std::size_t at = 0; at < to;) {
      if (is_digit(text[at]) || text[at] == '.') {  // a number, with the letter of its exponent
        const std::size_t end = end_of_number(text, at, to);
        plain += text.substr(at, end - at);
        at = end;
        continue;
      }
      if (!is_letter(text[at])) {
        plain += text[at++];
        continue;
      }
      const std::size_t end = end_of_word(text, at, to), open = after_space(text, end, to);
      const std::string_view name = text.substr(at, end - at);
      const char sign = open < to ? text[open] : ' ';
      const std::size_t close = sign == '[' || sign == '(' ? closing(text, open, to) : to;
      const std::string_view inside = close < to ? text.substr(open + 1, close - open - 1) : std::string_view();
      at = end;
      const bool closed = close < to;
      if (closed && (sign == '[' || has_indices(name))) {
        plain += keep(with_index("<mi>" + std::string(name) + "</mi>", markup_of_index(inside)));
        at = close + 1;
      } else if (closed && (name == "sum" || name == "prod")) {
        plain += keep(series(inside, name == "sum" ? "∑" : "∏"));
        at = close + 1;
      } else if (closed && name == "if" && (inside.find("==") != inside.npos || inside.find("!=") != inside.npos)) {
        plain += keep(choice(inside));
        at = close + 1;
      } else {
        plain += name;
      }
    }
    return plain;
  }
  bool has_indices(std::string_view name) const {
    if (vocabulary_ == nullptr) return false;
    const auto known = std::ranges::find(vocabulary_->definitions, name, &Vocabulary::Defined::name);
    return known != vocabulary_->definitions.end() && !known->indices.empty();
  }
  std::string series(std::string_view inside, const char* sign) {
    std::string signs;
    std::size_t from = 0;
    while (is_range(inside, from, inside.size())) {
      const std::size_t end = comma(inside, from, inside.size()), dots = inside.find("..", from);
      signs += std::string("<munderover><mo>") + sign + "</mo>" +
               row(markup_of_index(inside.substr(from, dots - from))) +
               row(markup_of_index(inside.substr(dots + 2, end - dots - 2))) + "</munderover>";
      from = end + 1;
    }
    const Made body = made(inside.substr(std::min(from, inside.size())));
    return row(signs + (body.adds ? row("<mo>(</mo>" + body.text + "<mo>)</mo>") : body.text));
  }
  std::string choice(std::string_view inside) {
    const std::size_t to = inside.size(), first = comma(inside, 0, to),
                      second = comma(inside, std::min(first + 1, to), to);
    const auto part = [&](std::size_t from, std::size_t end) { return inside.substr(std::min(from, to), end - from); };
    return row("<mo>{</mo><mtable><mtr><mtd>" + of(part(first + 1, second)) + "</mtd><mtd>" +
               markup_of_index(part(0, first)) + "</mtd></mtr><mtr><mtd>" + of(part(second + 1, to)) +
               "</mtd><mtd><mtext>else</mtext></mtd></mtr></mtable>");
  }

  const Vocabulary* vocabulary_;
  std::vector<std::string> pieces_;
  std::size_t depth_ = 0;
};

}  // namespace

std::string formula_of(const Definition& definition) {
  using Kind = Definition::Kind;
  const Definition& given = definition.typed ? definition.typed->scene : definition;
  Markup markup(definition.vocabulary.get());
  std::string inside;
  if (given.kind == Kind::equations) {
    for (const auto& [name, text] : given.equations)
      inside += "<mtr><mtd><mover>" + markup.of(name) + "<mo>˙</mo></mover></mtd><mtd><mo>=</mo></mtd><mtd>" +
                markup.of(text) + "</mtd></mtr>";
    inside = "<mtable>" + inside + "</mtable>";
  } else {
    const char* letter = given.kind == Kind::lagrangian ? "L" : given.kind == Kind::hamiltonian ? "H" : "V";
    inside = std::string("<mi>") + letter + "</mi><mo>=</mo>" + markup.of(given.formula);
  }
  const auto add = [&](const std::string& left, const std::string& text) {
    inside += "<mo>,</mo><mspace width=\"1em\"/>" + left + "<mo>=</mo>" + markup.of(text);
  };
  const auto more = [&](const char* name, const std::optional<std::string>& text) {
    if (text) add("<mi>" + std::string(name) + "</mi>", *text);
  };
  more("α", given.damping);
  more("γ", given.action_curvature);
  more("R", given.offset);
  for (const auto& [name, text] : given.forces) add("<msub><mi>F</mi>" + markup.of(name) + "</msub>", text);
  more("D", given.dissipation);
  if (definition.typed)
    for (const auto& [name, text] : definition.typed->definitions) add(markup.of(name), text);
  return "<math>" + inside + "</math>";
}

}  // namespace least::text
