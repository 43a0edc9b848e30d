// Why a step or a run ended.
#pragma once

#include <cstdint>
#include <string_view>

namespace least {

enum class ReturnCode : std::uint8_t {
  completed,
  not_finite,
  singular,
  solver_failed,
  unstable_step,
  left_domain,
  parameter_step_underflow,
  accumulating_events,
  step_limit,
  deadline,
  memory,
  cancelled,
};

/// The id a client reads.
constexpr std::string_view name(ReturnCode reason) {
  constexpr std::string_view names[] = {"completed",
                                        "not_finite",
                                        "singular",
                                        "solver_failed",
                                        "unstable_step",
                                        "left_domain",
                                        "parameter_step_underflow",
                                        "accumulating_events",
                                        "step_limit",
                                        "deadline",
                                        "memory",
                                        "cancelled"};
  return names[static_cast<std::size_t>(reason)];
}

/// What one step says of itself. A step that fails leaves the state as it was.
/// `underflow`: the steps of a scheme that sets its own clock became too small to go on.
enum class StepStatus : std::uint8_t { ok, solver_failed, singular, underflow };

/// What a step says whose state is made of T. A number with lanes brings a status for each of them, made from one for
/// all, with `all_failed` and `succeeded` beside it, so that a lane that fails does not fail the others.
template <class T>
struct StatusFor {
  using type = StepStatus;
};
template <class T>
using StatusOf = typename StatusFor<T>::type;

/// Where the mask says so, a step that went well so far has failed. True: there is nothing left that goes on, and the
/// step has to end.
constexpr bool all_failed(StepStatus& status, bool where, StepStatus why) {
  if (where) [[unlikely]] {
    status = why;
    return true;
  }
  return false;
}
constexpr bool succeeded(StepStatus status) { return status == StepStatus::ok; }

/// The work of a run, counted exactly: a force evaluation is one evaluation of the potential (where a step depends on
/// it), of its derivatives, of the Lagrangian's or of the vector field at one point, in whatever number; an iteration
/// is one update of an implicit step's solver.
struct Work {
  std::int64_t forces = 0, iterations = 0;
};

}  // namespace least
