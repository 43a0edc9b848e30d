// Program is a tape prepared for Taylor series: one pass over its lists computes one order of the series of every
// value. A value is a quantity whose coefficients are kept. A lane is the convolution Σ aⱼ b_{k−j} over 0 < j < k of
// the series of two values, which leaves out the terms with the order k that is being computed. All lanes of an order
// are summed in one loop; each step then adds the terms of order k. A sum of values and products with constant factors
// is one step.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/tape/tape.hpp"

namespace least::tape {

enum class Rule : std::uint8_t {
  sum,       ///< out = c + Σ cᵢ xᵢ + Σ dᵢ lanes: everything linear
  quotient,  ///< out = c a/b, the lane is (b, out); a none: c/b
  root,      ///< out = √a, the lane is (out, out)
  power,     ///< out = aᵖ; b = ȧ; the lane is (ȧ, out), lane number w is (a, ȯut)
  integral,  ///< ȯut = c w ȧ; b = ȧ, the lane is (ȧ, w); order 0 is f(p a), or the sum of the products if there are any
  log_like,  ///< ȯut = c ȧ/w; b = ȧ, the lane is (w, ȯut); order 0 is f(a)
  select,    ///< out = a where w < 0, else b
  // The same rules where one operand is linear in time: they need no lanes.
  linear_product,   ///< out = c a w, a linear
  linear_quotient,  ///< out = c a/b, b linear
  linear_power,     ///< a linear
  linear_integral,  ///< a linear
};

/// Step computes the coefficients of the value `out`. Operands are values by their number; ȧ stands for the value with
/// the coefficients k aₖ.
struct Step {
  Rule rule = Rule::sum;
  Op function = Op::constant;      ///< f
  Index out = none, weighted = 0;  ///< weighted: the value that receives k outₖ
  Index a = 0, b = 0, w = 0, lane = 0;
  Index first_value = 0, values = 0, first_product = 0, products = 0;
  double c = 1, p = 1;
};

/// SteepArgument is the argument of a steep function (core/tape/steep.hpp): `factor` times the value `argument`; for a
/// power, `factor` is the exponent.
struct SteepArgument {
  enum class Kind : std::uint8_t { exponential, saturating, hyperbolic, power };

  Kind kind = Kind::exponential;
  Index argument = none;
  double factor = 1;

  bool operator==(const SteepArgument&) const = default;
  /// Returns the argument in e-foldings of the function, clamped to the range in which the function matters: beyond it,
  /// e^x is negligible and tanh x is ±1.
  double foldings(double value) const;
  /// Whether a change of `value` by at most `change` is less than an e-folding.
  bool calm(double value, double change) const;
};

struct Program {
  struct Value {
    Index value;
    double factor;
  };
  struct Product {
    Index a, b, lane;
    double factor;
  };

  constexpr Program() = default;
  /// Prepares the rates ẋ of all variables, nodes of the tape in the order of the variables. The first `most` variables
  /// are the motion; the rates of the others do not change the motion by a bit.
  Program(const Tape& tape, std::span<const Index> rates, std::size_t most);

  std::size_t variables = 0, moving = 0;
  bool whole = true;     ///< series of the motion converge everywhere: rates linear in all variables, no quotients
  bool partial = false;  ///< some step of the motion is defined for some arguments only
  std::size_t motion_steps = 0, motion_lanes = 0;  ///< how many steps and lanes, the first ones, the motion needs
  std::vector<Step> linear, steps;  ///< linear: steps linear in time, which have coefficients of orders 0 and 1 only
  std::vector<Value> values;
  std::vector<Product> products;
  std::vector<Index> lane_a, lane_b;
  /// How an unrolled series sums lanes over j < k/2: a lane has two adjacent slots, aⱼ b_{k−j} and bⱼ a_{k−j}, or one
  /// slot if it is a square. By slot, `low` and `high` are the factors of lower and of higher order, padded to whole
  /// fours; by lane, `slot` is its first slot.
  std::vector<Index> low, high, slot;
  std::vector<Index> rate;      ///< by variable: the value that is its rate
  std::vector<Index> weighted;  ///< by variable, then for the time: the value that receives k times its coefficients
  std::vector<Index> switches;  ///< values whose sign selects between two formulas
  std::vector<Index> poles;     ///< values linear in time at whose zeros the rates may be infinite
  /// The cost of the motion: steps, steps whose order 0 is expensive (function calls, powers, roots), and fours of
  /// slots.
  struct Effort {
    std::size_t steps = 0, dear = 0, fours = 0;
  };
  // What the choice of step lengths reads. Only the constructor from a tape sets it.
  Effort effort;                     ///< of the program as lowered, before steps are reordered
  std::vector<SteepArgument> steep;  ///< steep functions of the motion; arguments are values
  bool conceals = false;             ///< the motion may change abruptly ahead without a steep function (may_conceal)
  std::vector<Index> branches;       ///< if `conceals`: values at whose zeros the motion may branch
  bool reads_time = false;           ///< the equations depend on the time
  Index rows = 0;  ///< number of values: 0 holds zero, 1 takes unused results, then variables and time
  static constexpr Index zero = 0, waste = 1, first_variable = 2;
  constexpr Index time() const { return first_variable + static_cast<Index>(variables); }
};

}  // namespace least::tape
