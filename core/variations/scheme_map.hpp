// The run of a scheme of fixed steps and its derivative along one direction of start and parameters: the derivative of
// the scheme's own map, by dual numbers through its steps. Where a step solves equations, it is the derivative of their
// solution.
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

/// Walk is what to follow; everything it refers to must outlive it.
struct Walk {
  const Request& request;
  const SchemeCard& scheme;
  const Grid& grid;
  std::span<const double> start, slope;  ///< start and direction, by component: q, p, and s where the motion needs it
  std::span<const std::int64_t> looks;   ///< ascending numbers of steps after which the state is wanted
  const KeepGoing& keep_going;
};

/// Walked holds the states at the looks and at the end, and their derivatives along the direction.
struct Walked {
  std::vector<std::vector<double>> states, slopes;
  std::string reason;  ///< why the end was not reached; empty where it was
};

/// go_over takes all steps of a walk: step(t, h) takes one from the time t, look() is called where the state is wanted.
/// Returns why the end was not reached; empty where it was.
template <class Look, class Step>
std::string go_over(const Walk& on, Look&& look, Step&& step) {
  constexpr std::int64_t between = 64;  // steps between two calls of keep_going
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

/// walk follows the scene of these equations; `moved` is the parameter that changes, none where only the start does.
Walked walk(const Walk& on, const ParametricScene& equations, std::optional<std::size_t> moved);
/// no_walk says why a scheme has no such derivative by these quantities; empty where it has one.
std::string no_walk(const Scene& scene, const SchemeCard& scheme, const ParametricScene& equations,
                    const std::vector<Quantity>& by);

/// WalkOf walks one class of problem. With a null walk it only tells, by returning a value, whether the scheme can be
/// walked.
using WalkOf = std::optional<Walked> (*)(const Walk* on, std::string_view scheme,
                                         const std::shared_ptr<const VariedFormulas>& formulas);
/// WalkClass is the class for a form, and the number of coordinates that it has room for.
struct WalkClass {
  WalkOf walk = nullptr;
  std::size_t room = 0;
};

// Each in a source of its own, to keep compilation short.
WalkClass walk_of_separable(bool full_mass);
WalkClass walk_of_damped(bool full_mass, bool constant);
WalkClass walk_of_quadratic(bool full_mass);
WalkClass walk_of_metric();
WalkClass walk_of_hamiltonian();
WalkClass walk_of_flow();
/// For scenes that are not compiled (Form::is_compiled): explicit schemes only, with room for more coordinates.
WalkClass walk_of_large(const text::Form& form);

}  // namespace least::variations
