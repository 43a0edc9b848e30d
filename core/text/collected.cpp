#include "core/text/collected.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "core/tape/derivative.hpp"
#include "core/text/expression.hpp"
#include "core/text/print.hpp"

namespace least::text {
namespace {

using tape::Index;
using tape::Node;
using tape::Op;

/// PowerOf is a power of a node that is neither product nor sum, or of a sum as a whole.
struct PowerOf {
  Index of;
  double power;
};
struct Summand {
  double coefficient = 1;
  std::vector<PowerOf> factors;  ///< by node, each node once

  bool is_like(const Summand& other) const {
    return std::ranges::equal(factors, other.factors,
                              [](const PowerOf& a, const PowerOf& b) { return a.of == b.of && a.power == b.power; });
  }
};
using Summands = std::vector<Summand>;  ///< in the order in which the terms first appeared

/// Limits: a sum of more than most_terms terms stays a factor; most_products bounds the products of terms that are
/// multiplied out in all.
constexpr std::size_t most_terms = 24, most_products = 2000, longest_text = 2000;

std::string digits_of(double x) {
  char digits[32];
  return {digits, std::to_chars(digits, digits + sizeof digits, x).ptr};
}

class Collector {
 public:
  /// `expands`: products of sums are multiplied out; otherwise a sum within a product stays one factor.
  Collector(const tape::Tape& tape, const Symbol& whole, const std::function<std::string(int)>& name, bool expands)
      : tape_(tape), whole_(whole), name_(name), expands_(expands), places_(tape::parts_of(tape, whole.place())) {
    terms_.reserve(places_.size());
    for (const Index place : places_) terms_.push_back(collect(place));
  }

  /// text() returns the text; nothing where it is too long.
  std::optional<std::string> text() {
    std::string all = text_of(terms_.back());
    return too_long_ ? std::nullopt : std::optional(std::move(all));
  }

 private:
  const Summands& at(Index place) const {
    return terms_[static_cast<std::size_t>(std::ranges::lower_bound(places_, place) - places_.begin())];
  }
  static Summands as_factor(Index place, double power = 1) { return {{1, {{place, power}}}}; }

  Summands collect(Index place) {
    const Node& node = tape_[place];
    switch (node.op) {
      case Op::constant:
        return node.value == 0 ? Summands{} : Summands{{node.value, {}}};
      case Op::add:
        return sum(place, at(node.a), at(node.b), 1);
      case Op::subtract:
        return sum(place, at(node.a), at(node.b), -1);
      case Op::multiply:
        if (is_number(node.a) || is_number(node.b)) return product(place, at(node.a), at(node.b));
        return product(place, as_part(node.a), as_part(node.b));
      case Op::divide:
        return product(place, as_part(node.a), to_the(node.b, -1));
      case Op::power:
        return to_the(node.a, node.value);
      case Op::sqrt:
        return to_the(node.a, 0.5);
      default:
        return as_factor(place);
    }
  }

  bool is_number(Index place) const { return tape_[place].op == Op::constant; }
  Summands as_part(Index place) const { return expands_ || at(place).size() <= 1 ? at(place) : as_factor(place); }
  Summands sum(Index place, const Summands& a, const Summands& b, double sign) {
    Summands all = a;
    for (const Summand& term : b) add(all, term, sign);
    return all.size() <= most_terms ? all : as_factor(place);
  }
  static void add(Summands& all, const Summand& term, double sign) {
    const auto like = std::ranges::find_if(all, [&](const Summand& one) { return one.is_like(term); });
    if (like == all.end()) {
      all.push_back(term);
      all.back().coefficient *= sign;
      return;
    }
    const double rounding = 4 * std::numeric_limits<double>::epsilon() * std::abs(like->coefficient);
    like->coefficient += sign * term.coefficient;
    // Terms such as thirds of cubes cancel but for rounding
    if (std::abs(like->coefficient) <= rounding) all.erase(like);
  }
  Summands product(Index place, const Summands& a, const Summands& b) {
    products_ += a.size() * b.size();
    if (products_ > most_products) return as_factor(place);
    Summands all;
    for (const Summand& left : a)
      for (const Summand& right : b) add(all, product_of(left, right), 1);
    return all.size() <= most_terms ? all : as_factor(place);
  }
  static Summand product_of(const Summand& a, const Summand& b) {
    Summand made{a.coefficient * b.coefficient, a.factors};
    for (const PowerOf& factor : b.factors) {
      const auto place = std::ranges::lower_bound(made.factors, factor.of, {}, &PowerOf::of);
      if (place == made.factors.end() || place->of != factor.of)
        made.factors.insert(place, factor);
      else if (place->power + factor.power == 0)
        made.factors.erase(place);
      else
        place->power += factor.power;
    }
    return made;
  }
  /// to_the returns a power: a single term with a whole exponent is raised factor by factor, anything else as a whole.
  Summands to_the(Index base, double power) {
    const Summands& of = at(base);
    if (of.size() != 1) return as_factor(base, power);
    const Summand& term = of.front();
    const bool whole = power == std::floor(power), alone = term.factors.size() == 1 && term.factors[0].power == 1;
    if (!whole && !(alone && term.coefficient == 1)) return as_factor(base, power);
    Summand made{std::pow(term.coefficient, power), term.factors};
    for (PowerOf& factor : made.factors) factor.power *= power;
    return std::isfinite(made.coefficient) ? Summands{std::move(made)} : as_factor(base, power);
  }

  std::string text_of(const Summands& terms) {
    if (terms.empty()) return "0";
    std::string text;
    for (const Summand& term : by_degree(terms)) {
      const bool negative = term.coefficient < 0;
      text.append(text.empty() ? (negative ? "-" : "") : negative ? " - " : " + ").append(text_of(term));
      if (text.size() > longest_text) too_long_ = true;
      if (too_long_) return text;
    }
    return text;
  }
  /// by_degree puts the terms of a long polynomial of one variable in order of its powers: the sum over powers that it
  /// comes from is added up in another order.
  Summands by_degree(const Summands& terms) const {
    constexpr std::size_t many = 5;
    const auto is_power = [&](const Summand& term) {
      return term.factors.empty() || (term.factors.size() == 1 && tape_[term.factors[0].of].op == Op::variable);
    };
    Summands ordered = terms;
    if (terms.size() < many || !std::ranges::all_of(terms, is_power)) return ordered;
    std::ranges::stable_sort(ordered, {}, [](const Summand& term) {
      return term.factors.empty() ? std::pair(Index(0), 0.0) : std::pair(term.factors[0].of, term.factors[0].power);
    });
    return ordered;
  }
  /// text_of returns a term without its sign: `2*x^3*sin(y)/(a*r^3)`.
  std::string text_of(const Summand& term) {
    auto [above, below] = fraction_of(std::abs(term.coefficient));
    std::size_t divisors = below.empty() ? 0 : 1;
    for (const PowerOf& factor : in_order(term)) {
      std::string& side = factor.power > 0 ? above : below;
      divisors += factor.power > 0 ? 0 : 1;
      if (!side.empty()) side += '*';
      side += text_of(factor.of, std::abs(factor.power));
    }
    if (above.empty()) above = "1";
    if (below.empty()) return above;
    return above.append("/").append(divisors > 1 ? "(" + below + ")" : below);
  }
  /// in_order puts parameters first, as they have the largest variable numbers, and functions and sums last.
  std::vector<PowerOf> in_order(const Summand& term) const {
    const auto number = [&](const PowerOf& factor) {
      return tape_[factor.of].op == Op::variable ? -tape_[factor.of].value : 0.5;
    };
    std::vector<PowerOf> factors = term.factors;
    std::ranges::stable_sort(factors, {}, number);
    return factors;
  }
  /// fraction_of returns a coefficient as numerator and denominator, "" for 1: ⅓ has many decimal digits, ½ has few.
  static std::pair<std::string, std::string> fraction_of(double x) {
    constexpr int largest = 64;
    constexpr std::size_t short_enough = 6;
    if (x == 1) return {};
    const std::string plain = digits_of(x);
    if (plain.size() <= short_enough) return {plain, {}};
    for (int below = 2; below <= largest; ++below) {
      const double above = std::round(x * below);
      if (above > 0 && above < 1e6 && above / below == x)
        return {above == 1 ? std::string() : digits_of(above), std::to_string(below)};
    }
    return {plain, {}};
  }
  std::string text_of(Index place, double power) {
    const Node& node = tape_[place];
    const bool named = node.op == Op::variable || node.op == Op::time;
    const bool called = function_name(node.op) || node.op == Op::select;
    std::string text = node.op == Op::time       ? "t"
                       : node.op == Op::variable ? name_(static_cast<int>(node.value))
                                                 : text_of_node(place);
    if (power == 0.5) return "sqrt(" + text + ")";
    if (!named && !called) text = "(" + text + ")";
    return power == 1 ? text : text + "^" + digits_of(power);
  }
  bool is_itself(Index place) const {
    const Summands& terms = at(place);
    return terms.size() == 1 && terms[0].coefficient == 1 && terms[0].factors.size() == 1 &&
           terms[0].factors[0].of == place && terms[0].factors[0].power == 1;
  }
  /// text_of_node prints a node that is no product or sum; its arguments are printed as collected terms.
  std::string text_of_node(Index place) {
    const Node& node = tape_[place];
    if (++depth_ > most_nesting || too_long_) {
      too_long_ = true;
      return {};
    }
    std::string text;
    if (!is_itself(place)) {
      text = text_of(at(place));
      std::string plain = print(tape_, Recorder::at(whole_, place), name_);
      if (plain.size() < text.size() && plain != "…") text = std::move(plain);
    } else if (const auto function = function_name(node.op)) {
      text.append(*function).append("(").append(text_of(at(node.a))).append(")");
    } else if (node.op == Op::select && is_absolute(tape_, node)) {
      text.append("abs(").append(text_of(at(node.c))).append(")");
    } else {  // another choice, a power with a varying exponent, or a sum of too many terms
      text = print(tape_, Recorder::at(whole_, place), name_);
    }
    --depth_;
    return text;
  }

  const tape::Tape& tape_;
  const Symbol& whole_;
  const std::function<std::string(int)>& name_;
  bool expands_;
  std::vector<Index> places_;
  std::vector<Summands> terms_;
  std::size_t products_ = 0, depth_ = 0;
  bool too_long_ = false;
};

}  // namespace

std::string print_collected(const tape::Tape& tape, const Symbol& y, const std::function<std::string(int)>& name) {
  std::string shortest = print(tape, y, name);
  if (y.is_constant() || shortest == "…") return shortest;
  for (const bool expands : {false, true})
    if (auto collected = Collector(tape, y, name, expands).text(); collected && collected->size() <= shortest.size())
      shortest = *std::move(collected);
  return shortest;
}

}  // namespace least::text
