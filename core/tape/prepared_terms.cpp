#include "core/tape/prepared_terms.hpp"

#include <algorithm>

#include "core/tape/derivative.hpp"
#include "core/tape/formula.hpp"
#include "core/tape/terms.hpp"
#include "core/tape/translation.hpp"

namespace least::tape {
namespace {

/// What a node depends on: constants alone; also on arguments that are a number for each term; or on what varies.
enum class Depends : std::uint8_t { constant, number, varies };

/// Returns the dependence of each node; is_number(k) says whether argument k is a number for each term.
template <class F>
std::vector<Depends> dependences(const Tape& tape, const F& is_number) {
  std::vector<Depends> all(nth(tape.size()), Depends::constant);
  for (Index i = 0; i < tape.size(); ++i) {
    const Node& node = tape[i];
    if (node.op == Op::variable) all[nth(i)] = is_number(node.value) ? Depends::number : Depends::varies;
    tape.for_each_operand(node, [&](Index part) { all[nth(i)] = std::max(all[nth(i)], all[nth(part)]); });
  }
  return all;
}

/// Rewrites a formula so that numbers are multiplied with each other before they multiply what varies. A value that is
/// read more than once has its factor applied once.
class FactorCollector {
 public:
  FactorCollector(const Tape& from, Tape& to, std::vector<Depends> depends)
      : from_(from), to_(to), depends_(std::move(depends)), made_(nth(from.size())), uses_(nth(from.size()), 0) {
    for (Index i = 0; i < from.size(); ++i) from.for_each_operand(from[i], [&](Index part) { ++uses_[nth(part)]; });
    for (Index i = 0; i < from.size(); ++i) made_[nth(i)] = product_of(i);
  }
  PreparedTerms::Result result(Index i) {
    const Product& product = made_[nth(i)];
    const bool turned = product.factor.is_constant() && product.factor.constant() == -1;
    return {(turned ? product.rest : whole(i)).on(to_), turned};
  }

 private:
  struct Product {
    Symbol factor = 1;  ///< a number
    Symbol rest = 1;
  };

  bool varies(Index i) const { return depends_[nth(i)] == Depends::varies; }
  Symbol whole(Index i) const { return made_[nth(i)].factor * made_[nth(i)].rest; }
  /// A node as an operand of a product.
  Product as_factor(Index i) const {
    if (!varies(i)) return {whole(i), 1};
    return uses_[nth(i)] > 1 ? Product{1, whole(i)} : made_[nth(i)];
  }

  /// a b, where powers of the same base become one power, which takes one root and one quotient.
  static Symbol times(const Symbol& a, const Symbol& b) {
    Symbol base, other;
    double p = 0, q = 0;
    const bool alike = Recorder::is_power(a, base, p) && Recorder::is_power(b, other, q) && Recorder::same(base, other);
    return alike ? pow(base, p + q) : a * b;
  }
  static Symbol over(const Symbol& a, const Symbol& b) {
    Symbol base;
    double p = 0;
    return Recorder::is_power(b, base, p) ? times(a, pow(base, -p)) : a / b;
  }

  Product product_of(Index i) {
    const Node& node = from_[i];
    if (node.op == Op::multiply && varies(i)) {
      const Product a = as_factor(node.a), b = as_factor(node.b);
      return {a.factor * b.factor, times(a.rest, b.rest)};
    }
    if (node.op == Op::divide && varies(node.b)) {
      const Product a = as_factor(node.a);
      return {a.factor, over(a.rest, whole(node.b))};
    }
    // Every other operation is copied, with rewritten operands.
    std::vector<Symbol> parts;
    Tape one;
    Node copy = node;
    Index next = 0;
    for (Index* part : {&copy.a, &copy.b, &copy.c}) {
      if (*part == none) continue;
      parts.push_back(whole(*part));
      *part = one.write({.op = Op::variable, .value = static_cast<double>(next++)});
    }
    if (node.op == Op::variable) return {1, Symbol::variable(to_, static_cast<std::size_t>(node.value))};
    const Index place = one.write(copy);
    Substitution write(one, to_, [&](int k) { return parts[static_cast<std::size_t>(k)]; });
    return {1, write.at(place)};
  }

  const Tape& from_;
  Tape& to_;
  std::vector<Depends> depends_;
  std::vector<Product> made_;
  std::vector<int> uses_;
};

}  // namespace

PreparedTerms::PreparedTerms(const Tape& tape, const Terms& terms)
    : numbers_(nth(terms.arguments)), count_(nth(terms.count)) {
  for (std::size_t k = 0; k < numbers_.size(); ++k)
    if (is_all(tape, terms, static_cast<Index>(k), Op::constant))
      for (std::size_t t = 0; t < count_; ++t) numbers_[k].push_back(tape[terms.given[k * count_ + t]].value);
  // An argument that is the same number for all terms becomes a constant.
  const Tape typed = tape_of(terms);
  Tape folded, collected;
  Substitution fold(typed, folded, [&](int i) {
    const std::vector<double>& known = numbers_[static_cast<std::size_t>(i)];
    const bool common = !known.empty() && std::ranges::all_of(known, [&](double y) { return y == known.front(); });
    return common ? Symbol(known.front()) : Symbol::variable(folded, static_cast<std::size_t>(i));
  });
  std::vector<Index> ends;
  for (const Index result : terms.results) ends.push_back(fold.at(result).on(folded));
  const auto is_number = [&](double argument) { return !numbers_[static_cast<std::size_t>(argument)].empty(); };
  FactorCollector collector(folded, collected, dependences(folded, is_number));
  for (const Index end : ends) results_.push_back(collector.result(end));
  precompute(collected);
}

void PreparedTerms::precompute(const Tape& from) {
  const auto is_number = [&](double argument) { return !numbers_[static_cast<std::size_t>(argument)].empty(); };
  const std::vector<Depends> depends = dependences(from, is_number);
  std::vector<bool> asked(nth(from.size()), false);  // numbers that results or nodes that vary read
  const auto ask = [&](Index part) {
    const bool made = depends[nth(part)] == Depends::number && from[part].op != Op::variable;
    asked[nth(part)] = asked[nth(part)] || made;
  };
  for (const Result& result : results_) ask(result.place);
  for (Index i = 0; i < from.size(); ++i)
    if (depends[nth(i)] == Depends::varies) from.for_each_operand(from[i], ask);
  std::vector<Index> places, made(nth(from.size()), none);
  for (Index i = 0; i < from.size(); ++i)
    if (asked[nth(i)]) places.push_back(i);
  std::size_t next = numbers_.size();
  if (!places.empty()) compute(from, places);
  for (Index i = 0; i < from.size(); ++i) {
    Node node = from[i];
    if (asked[nth(i)]) {
      node = {.op = Op::variable, .value = static_cast<double>(next++)};
    } else if (depends[nth(i)] == Depends::number && node.op != Op::variable) {
      continue;  // only other numbers read it
    }
    for (Index* part : {&node.a, &node.b, &node.c})
      if (*part != none) *part = made[nth(*part)];
    made[nth(i)] = formula_.write(node);
  }
  for (Result& result : results_) result.place = made[nth(result.place)];
}

void PreparedTerms::compute(const Tape& from, const std::vector<Index>& places) {
  const Formula formula(from, places);
  const std::size_t arguments = numbers_.size();
  std::vector<double> x(arguments), out(places.size());
  numbers_.resize(arguments + places.size(), std::vector<double>(count_));
  for (std::size_t t = 0; t < count_; ++t) {
    for (std::size_t k = 0; k < arguments; ++k)
      if (!numbers_[k].empty()) x[k] = numbers_[k][t];
    formula.evaluate(x.data(), 0.0, out.data());
    for (std::size_t k = 0; k < out.size(); ++k) numbers_[arguments + k][t] = out[k];
  }
}

}  // namespace least::tape
