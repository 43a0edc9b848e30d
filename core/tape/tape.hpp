// Tape is a list of the operations of formulas, each operation written once. Its nodes are constants, the time,
// variables and results of operations. Symbols (core/tape/symbol.hpp) write it when they take the place of numbers in
// the mechanics of a problem or in mechanics that a parser reads. Evaluators such as Taylor series
// (core/tape/series.hpp) are made from it.
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
  power,  ///< a^value; whole exponents from 0 to `most_factors` are products
  raise,  ///< a^b with b no constant; series are made of exp(b log a) in its place
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

/// Node is an operation, a constant, a variable or the time. Its operands a, b, c are earlier nodes of the tape.
/// Tape::write sets the flags `linear`, `partial` and `positive`.
struct Node {
  Op op = Op::constant;
  bool linear = false;    ///< the value is c₀ + c₁ t with constants c₀, c₁
  bool partial = false;   ///< a part, such as a logarithm, is NaN for some arguments
  bool positive = false;  ///< the value, where it is a number, is always ≥ 0, like a square
  Index a = none, b = none, c = none;
  double value = 0;
  double low = 0;  ///< for a constant: the constant is value + low

  constexpr bool is(const Node& other) const {
    return op == other.op && a == other.a && b == other.b && c == other.c && bits(value) == bits(other.value) &&
           bits(low) == bits(other.low);
  }
  constexpr std::size_t hash() const {
    std::uint64_t h = bits(value) + static_cast<std::uint64_t>(op);
    h ^= h >> 32;  // the lower half of a small whole number's bits is zero
    for (const Index part : {a, b, c}) h = (h ^ static_cast<std::uint64_t>(part + 1)) * 0x9e3779b97f4a7c15ULL;
    return static_cast<std::size_t>(h ^ (h >> 29));
  }

 private:
  static constexpr std::uint64_t bits(double x) { return std::bit_cast<std::uint64_t>(x); }
};

/// Terms describes sums of many terms of one form, such as Σ m[i] m[j]/r(i, j). The form is written once, as `formula`.
/// For every term, `given` lists the nodes of its arguments on the outer tape, and `into` the sums to which its results
/// are added, in the order of the terms.
struct Terms {
  std::vector<Node> formula;   ///< a tape of its own; its variable number k is argument k
  std::vector<Index> results;  ///< places in the formula
  Index arguments = 0, count = 0, sums = 0;
  std::vector<Index> given;     ///< [argument · count + term]: a node of the outer tape
  std::vector<Index> into;      ///< [result · count + term]: the number of a sum, or none
  std::vector<Index> operands;  ///< the nodes in `given`, each once, in the order of the tape

  bool operator==(const Terms& other) const;
};

/// A tape throws TooManyOperations when it is full. Callers that derive formulas bound the number of operations, and
/// thereby time and memory, with Tape::bound; they catch the exception and do without the derived formula.
struct TooManyOperations : std::length_error {
  TooManyOperations() : std::length_error("it takes too many operations") {}
};

/// The most operations that the equations of motion of a scene may have, and that a tape may have with everything
/// derived from them.
inline constexpr Index most_of_equations = 1 << 15, most_of_tape = 2 * most_of_equations;

class Tape {
 public:
  constexpr Tape() : places_(64, none) { nodes_.reserve(32); }

  /// Returns the place of the node, which is appended unless the tape has an equal one. Throws TooManyOperations.
  constexpr Index write(const Node& node) { return std::is_constant_evaluated() ? insert(node) : insert_at_run(node); }
  /// Limits the tape to `most` nodes from now on.
  constexpr void bound(Index most) { most_ = most; }

  constexpr const Node& operator[](Index i) const { return nodes_[static_cast<std::size_t>(i)]; }
  constexpr Index size() const { return static_cast<Index>(nodes_.size()); }

  /// Stores terms whose arguments are nodes of this tape, unless equal ones are stored already, and returns their
  /// number.
  Index keep(Terms terms);
  constexpr const Terms& terms(Index number) const { return terms_[static_cast<std::size_t>(number)]; }
  /// The terms of a node of Op::total.
  constexpr const Terms& terms(const Node& total) const { return terms(static_cast<Index>(total.low)); }
  constexpr bool has_terms() const { return !terms_.empty(); }
  /// Approximate memory in bytes.
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
  /// insert, compiled once for the equations of all problems, which are written at run time.
  Index insert_at_run(const Node& node);
  constexpr std::size_t place_of(const Node& node) const;
  constexpr bool is_linear(const Node& node) const;
  constexpr bool is_positive(const Node& node) const;
  constexpr bool is_partial(const Node& node) const;

  Index most_ = most_of_tape;
  std::vector<Node> nodes_;
  std::vector<Index> places_;  ///< hash table of the places of nodes, at most half full
  std::vector<Terms> terms_;
};

/// Returns the slot of the node in the hash table, or the empty slot for it.
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
