// The run of a scheme of equal steps, and how it changes along one direction of its start and its parameters: the
// derivative of the scheme's own map, by dual numbers through its steps. Where a step solves equations, the derivative
// is that of the solution.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/run/request.hpp"
#include "core/run/save_schedule.hpp"
#include "core/variations/sensitivities.hpp"
#include "core/variations/varied_problems.hpp"

namespace least::variations {

/// What is followed: all outlive the walk.
struct Walk {
  const Request& request;
  const SchemeCard& scheme;
  const Grid& grid;
  std::span<const double> start, slope;  ///< of the components: q, p, and s where the motion needs it
  std::span<const std::int64_t> looks;   ///< whole steps after which the state is wanted; they do not decrease
  const KeepGoing& keep_going;
};

/// States at the looks and at last at the end, and how they change.
struct Walked {
  std::vector<std::vector<double>> states, slopes;
  std::string reason;  ///< why it did not come to its end; empty: it did
};

/// All steps of a walk, `step(t, h)` being one from the time t, with `look` where the state is wanted; why it did not
/// come to its end, or nothing.
template <class Look, class Step>
std::string go_over(const Walk& on, Look&& look, Step&& step) {
  constexpr std::int64_t between = 64;  // looks at the clock
  auto next = on.looks.begin();
  double t = on.grid.start;
  for (std::int64_t n = on.grid.first;; ++n) {
    for (; next != on.looks.end() && *next <= n; ++next) look();
    if (n == on.grid.steps) break;
    if (n % between == 0 && !on.keep_going()) return "the time that the request has was over before they were found";
    if (step(t, on.grid.step) != StepStatus::ok) return "a step of the scheme could not be taken";
    t = on.grid.time(n + 1);
  }
  if (on.grid.tail > 0 && step(t, on.grid.tail) != StepStatus::ok)
    return "the last step of the scheme could not be taken";
  look();
  return {};
}

/// Of the scene whose equations these are; `moved`: the parameter that changes.
Walked walk(const Walk& on, const ParametricScene& equations, std::optional<std::size_t> moved);
/// Why there is none of a scheme that changes with these quantities; empty: there is.
std::string no_walk(const Scene& scene, const SchemeCard& scheme, const ParametricScene& equations,
                    const std::vector<Quantity>& by);

/// Of one class of problem. No walk: whether there is one is the answer.
using WalkOf = std::optional<Walked> (*)(const Walk* on, std::string_view scheme,
                                         const std::shared_ptr<const VariedFormulas>& formulas);
/// The class for a form, and how many coordinates it has room for.
struct WalkClass {
  WalkOf walk = nullptr;
  std::size_t room = 0;
};

// Compiled on their own.
WalkClass walk_of_separable(bool full_mass);
WalkClass walk_of_damped(bool full_mass, bool constant);
WalkClass walk_of_quadratic(bool full_mass);
WalkClass walk_of_metric();
WalkClass walk_of_hamiltonian();
WalkClass walk_of_flow();
/// Of more coordinates than the others have room for.
WalkClass walk_of_large(const text::Form& form);

}  // namespace least::variations
