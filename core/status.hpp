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

/// name returns the id that a client reads.
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

/// StepStatus is the result of one step. A step that fails leaves the state as it was. `underflow`: the steps of a
/// scheme that sets its own clock became too small to go on.
enum class StepStatus : std::uint8_t { ok, solver_failed, singular, underflow };

/// StatusOf<T> is the result of a step whose state is made of T. A number with lanes defines a status with one result
/// per lane, with its own `all_failed` and `succeeded`, so that a lane that fails does not fail the others.
template <class T>
struct StatusFor {
  using type = StepStatus;
};
template <class T>
using StatusOf = typename StatusFor<T>::type;

/// all_failed records the failure `why` where the mask `where` is set. It returns whether no lane goes on, in which
/// case the step has to end.
constexpr bool all_failed(StepStatus& status, bool where, StepStatus why) {
  if (where) [[unlikely]] {
    status = why;
    return true;
  }
  return false;
}
constexpr bool succeeded(StepStatus status) { return status == StepStatus::ok; }

/// Work counts the work of a run exactly. A force evaluation is one evaluation at one point, in any number type, of the
/// potential (where a step depends on it), of its derivatives, of the Lagrangian's derivatives or of the vector field;
/// an iteration is one update of the solver of an implicit step.
struct Work {
  std::int64_t forces = 0, iterations = 0;
};

}  // namespace least
