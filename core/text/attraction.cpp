#include "core/text/attraction.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

namespace least::text {
namespace {

using tape::Index;
using tape::Node;
using tape::Op;

/// Quadratic is a polynomial of degree two at most. Its coefficients are indexed by the numbers of two variables, the
/// smaller first; no_variable (−1) stands for a factor 1.
class Quadratic {
 public:
  using Key = std::pair<int, int>;
  static constexpr int no_variable = -1;

  /// of(tape, i, left) reads node i; nothing where it is no such polynomial, or has more than `left` parts.
  static std::optional<Quadratic> of(const tape::Tape& tape, Index i, int& left) {
    if (--left < 0) return std::nullopt;
    const Node& node = tape[i];
    const auto part = [&](Index j) { return of(tape, j, left); };
    Quadratic made;
    switch (node.op) {
      case Op::constant:
        made.all_[{no_variable, no_variable}] = node.value;
        return made;
      case Op::variable:
        made.all_[{no_variable, static_cast<int>(node.value)}] = 1;
        return made;
      case Op::add:
      case Op::subtract: {
        auto a = part(node.a);
        const auto b = part(node.b);
        if (!a || !b) return std::nullopt;
        for (const auto& [key, value] : b->all_) a->all_[key] += node.op == Op::add ? value : -value;
        return a;
      }
      case Op::multiply: {
        const auto a = part(node.a), b = node.a == node.b ? a : part(node.b);
        return a && b ? product(*a, *b) : std::nullopt;
      }
      case Op::divide: {
        auto a = part(node.a);
        if (!a || tape[node.b].op != Op::constant) return std::nullopt;
        for (auto& entry : a->all_) entry.second /= tape[node.b].value;
        return a;
      }
      default:
        return std::nullopt;
    }
  }

  double at(int a, int b) const {
    const auto found = all_.find({std::min(a, b), std::max(a, b)});
    return found == all_.end() ? 0 : found->second;
  }
  /// variables() returns the variables with a coefficient that is not 0.
  std::set<int> variables() const {
    std::set<int> found;
    for (const auto& [key, value] : all_)
      if (value != 0) found.insert({key.first, key.second});
    found.erase(no_variable);
    return found;
  }

 private:
  static std::optional<Quadratic> product(const Quadratic& a, const Quadratic& b) {
    constexpr std::size_t most = 16;  // terms of a factor; a squared distance in space has 6 variables
    if (a.all_.size() > most || b.all_.size() > most) return std::nullopt;
    Quadratic made;
    for (const auto& [x, u] : a.all_)
      for (const auto& [y, v] : b.all_) {
        std::array<int, 4> all{x.first, x.second, y.first, y.second};
        std::ranges::sort(all);
        if (all[1] != no_variable) return std::nullopt;  // degree three or four
        made.all_[{all[2], all[3]}] += u * v;
      }
    return made;
  }

  std::map<Key, double> all_;
};

Monomial monomial(const tape::Tape& tape, Index i, int& left) {
  const Monomial itself{1, i, 1};
  if (--left < 0) return itself;
  const Node& node = tape[i];
  const auto part = [&](Index j) { return monomial(tape, j, left); };
  switch (node.op) {
    case Op::constant:
      return {node.value};
    case Op::sqrt:
    case Op::power: {
      const double exponent = node.op == Op::sqrt ? 0.5 : node.value;
      const Monomial a = part(node.a);
      return {std::pow(a.factor, exponent), a.base, a.exponent * exponent};
    }
    case Op::multiply:
    case Op::divide: {
      const Monomial a = part(node.a), b = node.a == node.b ? a : part(node.b);
      if (a.base != tape::none && b.base != tape::none && a.base != b.base) return itself;
      const bool over = node.op == Op::divide;
      return {over ? a.factor / b.factor : a.factor * b.factor, a.base == tape::none ? b.base : a.base,
              over ? a.exponent - b.exponent : a.exponent + b.exponent};
    }
    default:
      return itself;
  }
}

}  // namespace

Monomial Monomial::of(const tape::Tape& tape, Index i) {
  int left = 64;
  return monomial(tape, i, left);
}

std::optional<Attraction> Attraction::of(const tape::Tape& tape, const Monomial& term) {
  if (term.base == tape::none || term.exponent != -0.5) return std::nullopt;
  int parts = 256;
  const auto u = Quadratic::of(tape, term.base, parts);
  if (!u) return std::nullopt;
  const std::set<int> variables = u->variables();
  if (variables.empty() || variables.size() > 6) return std::nullopt;
  constexpr int none = Quadratic::no_variable;
  const int first = *variables.begin();
  const double scale = u->at(first, first), small = 1e-13;
  // A larger constant is a softened attraction
  constexpr double round_off = 8 * std::numeric_limits<double>::epsilon();
  if (!(scale > 0)) return std::nullopt;
  const auto is = [&](double x, double y) { return std::abs(x - y) <= small * scale; };
  Attraction made;
  made.strength = -term.factor / std::sqrt(scale);
  double rest = u->at(none, none), size = std::abs(rest);
  std::set<int> left = variables;
  for (const int i : variables) {
    if (!is(u->at(i, i), scale)) return std::nullopt;
    if (!left.contains(i)) continue;
    left.erase(i);
    const auto partner = std::ranges::find_if(variables, [&](int j) { return j != i && u->at(i, j) != 0; });
    if (partner == variables.end()) {
      const double c = -u->at(none, i) / (2 * scale);
      made.axes.emplace_back(i, none);
      made.centre.push_back(c);
      rest -= scale * c * c;
      size += scale * c * c;
      continue;
    }
    const bool twice = std::ranges::any_of(variables, [&](int j) {
      return (j != i && j != *partner && u->at(i, j) != 0) || (j != i && j != *partner && u->at(*partner, j) != 0);
    });
    if (twice || !left.contains(*partner) || !is(u->at(i, *partner), -2 * scale) || u->at(none, i) != 0 ||
        u->at(none, *partner) != 0)
      return std::nullopt;
    left.erase(*partner);
    made.axes.emplace_back(i, *partner);
  }
  const bool mixed = made.is_fixed() && made.centre.size() != made.axes.size();
  const std::size_t dimension = made.axes.size();
  if (mixed || dimension < 2 || dimension > 3 || !(std::abs(rest) <= round_off * size) || !std::isfinite(made.strength))
    return std::nullopt;
  return made;
}

}  // namespace least::text
