// A step written down operation by operation, as units of lanes run it of scenes that were given as text. Numbers that
// all members share, as what follows from the step and the time, are computed once; the others in lanes, for all packs
// of a group before the next operation, which hides what reading it costs. Where each of them stands is a register.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace least {

enum class LaneCode : std::uint8_t {
  add,
  subtract,
  multiply,
  divide,
  // With a shared number in the place of a or b, as the name has it.
  add_shared,       ///< a + shared b
  subtract_shared,  ///< a − shared b
  from_shared,      ///< shared a − b
  scale,            ///< shared a · b
  divide_shared,    ///< a / shared b
  over_shared,      ///< shared a / b
  // Two operations, each rounded.
  add_product,       ///< a + b c
  subtract_product,  ///< a − b c
  add_scaled,        ///< a + shared b · c
  subtract_scaled,   ///< a − shared b · c
  copy,
  spread,  ///< shared a, in every lane
  // Functions of numbers of one kind.
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

/// What a program says of a step, as a number. Where several are true it is the first of them.
enum class StepFailure : std::uint8_t { none, singular, left_domain, unstable };

struct LaneInstruction {
  LaneCode code = LaneCode::copy;
  std::uint32_t out = 0, a = 0, b = 0, c = 0;
};

/// Instructions in the order in which they are run. Those of shared numbers know no others.
struct LanePart {
  std::span<const LaneInstruction> of_step;     ///< shared: what follows from the length of the step alone
  std::span<const LaneInstruction> of_members;  ///< in lanes: what follows from that and from constants of one's own
  std::span<const LaneInstruction> of_time;     ///< shared, for every step anew
  std::span<const LaneInstruction> of_lanes;
};

/// Shared registers: t, h, then what `shared` says. Registers in lanes: first the state, then the constants that each
/// member has of its own, then the rest.
struct LaneProgram {
  std::span<const double> shared;              ///< of all but t and h, at the beginning
  std::span<const std::uint32_t> rows;         ///< the variables that the state is made of, by their place on the card
  std::size_t own = 0;                         ///< how many constants each member has of its own
  std::size_t registers = 0;                   ///< in lanes
  LanePart start;                              ///< makes what a step finds of the one before it
  LanePart step;                               ///< from one state to the next
  std::span<const LaneInstruction> after;      ///< shared: what the next step finds of this one
  std::span<const std::uint32_t> kept_shared;  ///< registers of what a step finds of the one before it
  std::span<const std::uint32_t> kept;
  std::span<const std::uint32_t> outputs;  ///< of a program that makes no step: where its values stand
  std::int32_t failed = -1;                ///< a register with the StepFailure of each lane; −1: no step fails
  std::int64_t forces_at_start = 0, forces_of_step = 0;
};

}  // namespace least
