// A step as a list of operations, which units of lanes interpret for scenes given as text. Numbers that all members
// share, such as those that depend on step and time only, are computed once; others are computed in lanes, each
// operation for all packs of a group before the next one, which hides the cost of decoding it. Operands are registers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace least {

/// LaneCode is the operation of an instruction, with operands a, b and c.
enum class LaneCode : std::uint8_t {
  add,
  subtract,
  multiply,
  divide,
  // In these, a or b is a shared register, as the name says.
  add_shared,       ///< a + shared b
  subtract_shared,  ///< a − shared b
  from_shared,      ///< shared a − b
  scale,            ///< shared a · b
  divide_shared,    ///< a / shared b
  over_shared,      ///< shared a / b
  // Two operations, each rounded on its own (no fused multiply-add).
  add_product,       ///< a + b c
  subtract_product,  ///< a − b c
  add_scaled,        ///< a + shared b · c
  subtract_scaled,   ///< a − shared b · c
  copy,
  spread,  ///< shared a, in every lane
  // Functions, whose operands are all in lanes or all shared.
  raise,  ///< a to the power b
  sqrt,
  exp,
  expm1,
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
  abs,
  less,         ///< 1 where a < b, else 0
  not_greater,  ///< 1 where a ≤ b, else 0
  select        ///< b where a is not 0, else c
};

/// StepFailure is what a program reports of a step, as a number. If several apply, the first one is reported.
enum class StepFailure : std::uint8_t { none, singular, left_domain, unstable };

/// LaneInstruction writes register `out` from registers a, b and c.
struct LaneInstruction {
  LaneCode code = LaneCode::copy;
  std::uint32_t out = 0, a = 0, b = 0, c = 0;
};

/// LanePart is a list of instructions in the order of execution. Shared instructions read shared registers only.
struct LanePart {
  std::span<const LaneInstruction> of_step;  ///< shared: depends on the step length alone; run when that changes
  /// in lanes: depends on the step length and on the members' own constants
  std::span<const LaneInstruction> of_members;
  std::span<const LaneInstruction> of_time;  ///< shared: run in every step
  std::span<const LaneInstruction> of_lanes;
};

/// LaneProgram. Shared registers are t, h, then `shared`. Registers in lanes are the state, then the constants of which
/// each member has its own, then the rest.
struct LaneProgram {
  std::span<const double> shared;          ///< initial values of the shared registers behind t and h
  std::span<const std::uint32_t> rows;     ///< by component of the state, its place on the card
  std::size_t own = 0;                     ///< how many constants each member has of its own
  std::size_t registers = 0;               ///< in lanes
  LanePart start;                          ///< computes, once, the values that a step expects from the step before it
  LanePart step;                           ///< from one state to the next
  std::span<const LaneInstruction> after;  ///< shared: prepares the values that the next step expects from this one
  std::span<const std::uint32_t> kept_shared;  ///< registers that carry values from one step to the next
  std::span<const std::uint32_t> kept;
  std::span<const std::uint32_t> outputs;  ///< of a program without a step: the registers of its values
  std::int32_t failed = -1;                ///< register with the StepFailure of each lane; −1: steps cannot fail
  std::int64_t forces_at_start = 0, forces_of_step = 0;
};

}  // namespace least
