// A tape: a formula written down operation by operation, with nothing written twice. Its numbers are constants, the
// time, variables and what operations make of them. It is written by symbols (core/tape/symbol.hpp) that take the place
// of numbers in the mechanics of a problem, or in those that a parser reads; what it is good for is made from it, as
// Taylor series are (core/tape/series.hpp).
// Source: Griewank & Walther, Evaluating Derivatives, 2008, chapter 2.
#pragma once

#include <cstddef>
#include <cstdint>
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
  select  ///< b where a < 0, else c
};

/// Operands lie before what is made of them.
struct Node {
  Op op = Op::constant;
  bool linear = false;  ///< of the first degree in time and a function of nothing else; derived
  Index a = none, b = none, c = none;
  double value = 0;
  double low = 0;  ///< of a constant what `value` is short of it
};

class Tape {
 public:
  Tape() : places_(64, none) { nodes_.reserve(32); }

  /// The place of the node, which is written where it does not stand yet.
  Index write(Node node);

  const Node& operator[](Index i) const { return nodes_[static_cast<std::size_t>(i)]; }
  Index size() const { return static_cast<Index>(nodes_.size()); }

 private:
  std::size_t place_of(const Node& node) const;
  bool is_linear(const Node& node) const;

  std::vector<Node> nodes_;
  std::vector<Index> places_;  ///< a hash table of them, at most half full
};

}  // namespace least::tape
