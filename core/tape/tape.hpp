// A tape: a formula written down operation by operation, with nothing written twice. Its numbers are constants, the
// time, variables and what operations make of them. It is written by symbols (core/tape/symbol.hpp) that take the place
// of numbers in the mechanics of a problem, or in those that a parser reads; what it is good for is made from it, as
// Taylor series are (core/tape/series.hpp).
// Source: Griewank & Walther, Evaluating Derivatives, 2008, chapter 2.
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <type_traits>
#include <vector>

namespace least::tape {

/// A place on the tape.
using Index = std::int32_t;
inline constexpr Index none = -1;

enum class Op : std::uint8_t {
  constant,  ///< `value`
  time,
  variable,  ///< number `value`
  add,
  subtract,
  multiply,
  divide,
  power,  ///< a^value, of no whole exponent from 0 to `most_factors`
  raise,  ///< a^b of two that vary; no series are made of it
  sqrt,
  exp,
  log,
  sin,
  cos,
  tan,
  sinh,
  cosh,
  tanh,
  atan,
  asin,
  acos,
  select,  ///< b where a < 0, else c
  total    ///< sum number `value` of the terms number `low` (Terms)
};

/// Operands lie before what is made of them.
struct Node {
  Op op = Op::constant;
  bool linear = false;    ///< of the first degree in time and a function of nothing else; derived
  bool partial = false;   ///< something in it, as a logarithm, is no number of some arguments; derived
  bool positive = false;  ///< or zero, whatever its arguments, where it is a number: as a square; derived
  Index a = none, b = none, c = none;
  double value = 0;
  double low = 0;  ///< of a constant what `value` is short of it

  constexpr bool is(const Node& other) const {
    return op == other.op && a == other.a && b == other.b && c == other.c && bits(value) == bits(other.value) &&
           bits(low) == bits(other.low);
  }
  constexpr std::size_t hash() const {
    std::uint64_t h = bits(value) + static_cast<std::uint64_t>(op);
    h ^= h >> 32;  // of small whole numbers the lower half is zero
    for (const Index part : {a, b, c}) h = (h ^ static_cast<std::uint64_t>(part + 1)) * 0x9e3779b97f4a7c15ULL;
    return static_cast<std::size_t>(h ^ (h >> 29));
  }

 private:
  static constexpr std::uint64_t bits(double x) { return std::bit_cast<std::uint64_t>(x); }
};

/// Terms alike, as those of Σ m[i] m[j]/r(i, j): one formula of a few arguments, written once; of every term the places
/// on the tape of its arguments, and the sums that its results are added to, in the order of the terms.
struct Terms {
  std::vector<Node> formula;   ///< a tape of its own; its variable number k is argument k
  std::vector<Index> results;  ///< places in the formula
  Index arguments = 0, count = 0, sums = 0;
  std::vector<Index> given;     ///< by argument, then by term
  std::vector<Index> into;      ///< by result, then by term: the number of a sum; none where it is in none
  std::vector<Index> operands;  ///< every place that is given, once, in the order of the tape

  bool operator==(const Terms& other) const;
};

/// What a tape throws that is full. Whoever derives something bounds what that may take, in operations and so in time
/// and memory, and does without where it takes more.
struct TooManyOperations : std::length_error {
  TooManyOperations() : std::length_error("it takes too many operations") {}
};

/// Operations of the equations of motion of a scene, and of what is derived from them.
inline constexpr Index most_of_equations = 1 << 15, most_of_tape = 2 * most_of_equations;

class Tape {
 public:
  constexpr Tape() : places_(64, none) { nodes_.reserve(32); }

  /// The place of the node, which is written where it does not stand yet.
  constexpr Index write(const Node& node) { return std::is_constant_evaluated() ? insert(node) : insert_at_run(node); }
  /// From now on no more nodes than so many are written.
  constexpr void bound(Index most) { most_ = most; }

  constexpr const Node& operator[](Index i) const { return nodes_[static_cast<std::size_t>(i)]; }
  constexpr Index size() const { return static_cast<Index>(nodes_.size()); }

  /// Keeps terms whose arguments stand here, unless the same are kept already: their number.
  Index keep(Terms terms);
  constexpr const Terms& terms(Index number) const { return terms_[static_cast<std::size_t>(number)]; }
  /// Those that a total is one of the sums of.
  constexpr const Terms& terms(const Node& total) const { return terms(static_cast<Index>(total.low)); }
  constexpr bool has_terms() const { return !terms_.empty(); }
  /// What it takes in memory, about.
  std::size_t bytes() const;

  /// Calls f with the place of each operand of a node.
  template <class F>
  constexpr void for_each_operand(const Node& node, F&& f) const {
    if (node.op == Op::total) {
      for (const Index part : terms(node).operands) f(part);
      return;
    }
    for (const Index part : {node.a, node.b, node.c})
      if (part != none) f(part);
  }

 private:
  constexpr Index insert(Node node);
  /// The same, compiled once: every problem's equations are written when the program runs.
  Index insert_at_run(const Node& node);
  constexpr std::size_t place_of(const Node& node) const;
  constexpr bool is_linear(const Node& node) const;
  constexpr bool is_positive(const Node& node) const;
  constexpr bool is_partial(const Node& node) const;

  Index most_ = most_of_tape;
  std::vector<Node> nodes_;
  std::vector<Index> places_;  ///< a hash table of them, at most half full
  std::vector<Terms> terms_;
};

/// Where it stands in the table, or the empty place for it.
constexpr std::size_t Tape::place_of(const Node& node) const {
  const std::size_t mask = places_.size() - 1;
  std::size_t place = node.hash() & mask;
  while (places_[place] != none && !(*this)[places_[place]].is(node)) place = (place + 1) & mask;
  return place;
}

constexpr bool Tape::is_linear(const Node& node) const {
  const auto fixed = [&](Index i) { return (*this)[i].op == Op::constant; };
  const auto linear = [&](Index i) { return (*this)[i].linear || fixed(i); };
  switch (node.op) {
    case Op::time:
      return true;
    case Op::add:
    case Op::subtract:
      return linear(node.a) && linear(node.b);
    case Op::multiply:
      return linear(node.a) && linear(node.b) && (fixed(node.a) || fixed(node.b));
    case Op::divide:
      return linear(node.a) && fixed(node.b);
    default:
      return false;
  }
}

constexpr bool Tape::is_positive(const Node& node) const {
  const auto positive = [&](Index i) { return (*this)[i].positive; };
  switch (node.op) {
    case Op::constant:
      return node.value >= 0;
    case Op::exp:
    case Op::cosh:
    case Op::sqrt:
      return true;
    case Op::multiply:
      return node.a == node.b || (positive(node.a) && positive(node.b));
    case Op::add:
    case Op::divide:
      return positive(node.a) && positive(node.b);
    case Op::power:
      return positive(node.a);
    case Op::select:
      return positive(node.b) && positive(node.c);
    default:
      return false;
  }
}

constexpr bool Tape::is_partial(const Node& node) const {
  bool any = false;
  for_each_operand(node, [&](Index i) { any = any || (*this)[i].partial; });
  switch (node.op) {
    case Op::constant:
      return std::isnan(node.value);
    case Op::sqrt:
    case Op::log:
    case Op::power:
    case Op::raise:
      return any || !(*this)[node.a].positive;
    case Op::asin:
    case Op::acos:
      return true;
    case Op::total: {
      const std::vector<Node>& formula = terms(node).formula;
      for (const Node& part : formula) any = any || part.partial;
      return any;
    }
    default:
      return any;
  }
}

constexpr Index Tape::insert(Node node) {
  std::size_t place = place_of(node);
  if (places_[place] != none) return places_[place];
  if (size() >= most_) throw TooManyOperations();
  node.linear = is_linear(node);
  node.positive = is_positive(node);
  node.partial = is_partial(node);
  nodes_.push_back(node);
  const Index written = size() - 1;
  if (2 * nodes_.size() < places_.size()) return places_[place] = written;
  places_.assign(2 * places_.size(), none);
  for (Index i = 0; i <= written; ++i) places_[place_of((*this)[i])] = i;
  return written;
}

}  // namespace least::tape
