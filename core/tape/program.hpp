// A tape made ready for Taylor series: what an order of the series of every quantity costs is one pass over these
// lists. A value is a quantity whose coefficients are kept; a lane is the product of the series of two values, without
// the terms of the order that is being computed: Σ aⱼ b_{k−j} over 0 < j < k. All lanes are summed in one loop,
// whatever becomes of them; a step then adds the terms that are new. Sums of what is multiplied by constants are one
// step.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/tape/tape.hpp"

namespace least::tape {

enum class Rule : std::uint8_t {
  sum,       ///< out = c + Σ cᵢ xᵢ + Σ dᵢ lanes: everything linear
  quotient,  ///< out = c a/b, the lane is (b, out); a none: c/b
  root,      ///< out = √a, (out, out)
  power,     ///< out = aᵖ: b = ȧ; lanes (ȧ, out) and, number w, (a, ȯut)
  integral,  ///< ȯut = c w ȧ: b = ȧ, (ȧ, w); at the start f(p a), the sum of the products if there are any
  log_like,  ///< ȯut = c ȧ/w: b = ȧ, (w, ȯut); at the start f(a)
  select,    ///< out = a where w < 0, else b
  // The same where one of the two is linear in time; no lanes.
  linear_product,   ///< out = c a w, a linear
  linear_quotient,  ///< out = c a/b, b linear
  linear_power,     ///< a linear
  linear_integral,  ///< a linear
};

/// Values are rows of coefficients; ȧ stands for the row of k aₖ.
struct Step {
  Rule rule = Rule::sum;
  Op function = Op::constant;      ///< f
  Index out = none, weighted = 0;  ///< weighted: where k outₖ goes, too
  Index a = 0, b = 0, w = 0, lane = 0;
  Index first_value = 0, values = 0, first_product = 0, products = 0;
  double c = 1, p = 1;
};

/// A steep function (core/tape/steep.hpp) of `factor` times the value at `argument`; of a power, `factor` is the
/// exponent.
struct SteepArgument {
  enum class Kind : std::uint8_t { exponential, saturating, hyperbolic, power };

  Kind kind = Kind::exponential;
  Index argument = none;
  double factor = 1;

  bool operator==(const SteepArgument&) const = default;
  /// The argument in e-foldings of the function, held at the ends of the range in which the function is of consequence:
  /// beyond them e^x is nothing, and tanh x is ±1.
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
  /// Of a tape the rates ẋ of the variables, in their order; the first `most` of them are the motion, which what
  /// follows after them does not change by a bit.
  Program(const Tape& tape, std::span<const Index> rates, std::size_t most);

  std::size_t variables = 0, moving = 0;
  bool whole = true;     ///< the series of the motion converge everywhere: linear in all variables, nothing divided
  bool partial = false;  ///< some rule is defined for some arguments only
  std::size_t motion_steps = 0, motion_lanes = 0;  ///< how many of them, the first ones, the motion needs
  std::vector<Step> linear, steps;  ///< linear: those linear in time, of which two coefficients are not zero
  std::vector<Value> values;
  std::vector<Product> products;
  std::vector<Index> lane_a, lane_b;
  /// Lanes as they are summed: aⱼ b_{k−j} and bⱼ a_{k−j} side by side, for j < k/2; of a square one is enough. By slot
  /// the factors of the lower order and of the higher, filled up to fours; by lane its first slot.
  std::vector<Index> low, high, slot;
  std::vector<Index> rate;      ///< the value that is the rate of a variable
  std::vector<Index> weighted;  ///< where k times the coefficients of a variable, and of the time after them, go
  std::vector<Index> switches;  ///< values at whose zeros the formulas change
  std::vector<Index> poles;     ///< values linear in time at whose zeros the rates may be infinite
  /// What an order of the motion takes: steps, those whose order 0 is dear, and fours of slots.
  struct Effort {
    std::size_t steps = 0, dear = 0, fours = 0;
  };
  // What steps have to heed, of a program that was made from a tape when it runs.
  Effort effort;                     ///< as it was lowered, however it is put in order since
  std::vector<SteepArgument> steep;  ///< those that the motion depends on: arguments are values
  bool conceals = false;             ///< the motion depends on what may hide ahead without one
  std::vector<Index> branches;       ///< of a motion that does: values at whose zeros it may branch
  bool reads_time = false;           ///< the equations do
  Index rows = 0;  ///< how many values there are. 0: nothing at all; 1: of no use; then the variables; time
  static constexpr Index zero = 0, waste = 1, first_variable = 2;
  constexpr Index time() const { return first_variable + static_cast<Index>(variables); }
};

}  // namespace least::tape
