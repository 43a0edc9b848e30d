#include "core/text/print.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <vector>

#include "core/tape/derivative.hpp"
#include "core/text/expression.hpp"

namespace least::text {
namespace {

using tape::Index;
using tape::Node;
using tape::Op;

constexpr std::size_t longest = 2000;

/// Piece is a text and its precedence: 1 sum, 2 product, 3 unary minus, 4 power, 5 needs no brackets.
struct Piece {
  std::string text;
  int binds = 5;
};

std::string number(double x) {
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof digits, x).ptr;
  return {digits, end};
}
Piece constant(double x) { return {number(x), x < 0 ? 3 : 5}; }

/// joined concatenates without moving from a literal, which g++ 12 reports as an overrun.
std::string joined(std::initializer_list<std::string_view> parts) {
  std::string text;
  for (const std::string_view part : parts) text.append(part);
  return text;
}
std::string in(const Piece& x, int tighter) { return x.binds < tighter ? joined({"(", x.text, ")"}) : x.text; }

/// negative(x) tells whether x is `-…`; without_sign removes that sign.
bool negative(const Piece& x) { return x.binds == 3; }
Piece without_sign(const Piece& x) { return negative(x) ? Piece{x.text.substr(1), 3} : x; }

/// nesting(text) returns the depth of brackets; a printed text may be nested deeper than the text it was read from, by
/// one for each minus in an exponent.
std::size_t nesting(std::string_view text) {
  std::size_t open = 0, most = 0;
  for (const char c : text) {
    if (c == '(') most = std::max(most, ++open);
    if (c == ')') --open;
  }
  return most;
}

/// is_zero_node recognises the term 0·x that a select adds, so that its value is NaN where x is.
bool is_zero_node(const tape::Tape& tape, Index place) {
  const Node& node = tape[place];
  return node.op == Op::multiply && tape[node.a].op == Op::constant && tape[node.a].value == 0;
}

/// of_node prints one node; part(i) is the text of an earlier node.
template <class Part>
Piece of_node(const tape::Tape& tape, Index place, Part&& part, const std::function<std::string(int)>& name) {
  const Node& node = tape[place];
  switch (node.op) {
    case Op::constant:
      return constant(node.value);
    case Op::time:
      return {"t"};
    case Op::variable:
      return {name(static_cast<int>(node.value))};
    case Op::add:
    case Op::subtract: {
      if (is_zero_node(tape, node.b)) return part(node.a);
      const bool adds = (node.op == Op::add) != negative(part(node.b));
      return {joined({in(part(node.a), 1), adds ? " + " : " - ", in(without_sign(part(node.b)), 2)}), 1};
    }
    case Op::multiply:
      if (node.a == node.b) return {joined({in(part(node.a), 5), "^2"}), 4};
      if (part(node.a).text == "-1" && negative(part(node.b))) return without_sign(part(node.b));
      if (part(node.a).text == "-1") return {joined({"-", in(part(node.b), 3)}), 3};
      return {joined({in(part(node.a), 2), "*", in(part(node.b), 4)}), 2};
    case Op::divide:
      return {joined({in(part(node.a), 2), "/", in(part(node.b), 4)}), 2};
    case Op::power:
      return {joined({in(part(node.a), 5), "^", in(constant(node.value), 5)}), 4};
    case Op::raise:
      return {joined({in(part(node.a), 5), "^", in(part(node.b), 5)}), 4};
    case Op::select:
      if (is_absolute(tape, node)) return {joined({"abs(", part(node.c).text, ")"})};
      return {joined({"if(", part(node.a).text, " < 0, ", part(node.b).text, ", ", part(node.c).text, ")"})};
    default:
      return {joined({*function_name(node.op), "(", part(node.a).text, ")"})};
  }
}

}  // namespace

std::optional<std::string_view> function_name(Op op) {
  switch (op) {
    case Op::sqrt:
      return "sqrt";
    case Op::exp:
      return "exp";
    case Op::log:
      return "log";
    case Op::sin:
      return "sin";
    case Op::cos:
      return "cos";
    case Op::tan:
      return "tan";
    case Op::sinh:
      return "sinh";
    case Op::cosh:
      return "cosh";
    case Op::tanh:
      return "tanh";
    case Op::atan:
      return "atan";
    case Op::asin:
      return "asin";
    case Op::acos:
      return "acos";
    default:
      return std::nullopt;
  }
}

bool is_absolute(const tape::Tape& tape, const Node& choice) {
  const Node& negated = tape[choice.b];
  return choice.a == choice.c && negated.op == Op::multiply && negated.b == choice.c &&
         tape[negated.a].op == Op::constant && tape[negated.a].value == -1;
}

std::string print(const tape::Tape& tape, const Symbol& y, const std::function<std::string(int)>& name) {
  if (y.is_constant()) return number(y.constant());
  const std::vector<Index> places = tape::parts_of(tape, y.place());
  std::vector<Piece> made(places.size());
  const auto part = [&](Index place) -> const Piece& {
    return made[static_cast<std::size_t>(std::ranges::lower_bound(places, place) - places.begin())];
  };
  for (std::size_t i = 0; i < made.size(); ++i) {
    made[i] = of_node(tape, places[i], part, name);
    if (made[i].text.size() > longest) return "…";
  }
  return nesting(made.back().text) > most_nesting ? "…" : made.back().text;
}

}  // namespace least::text
