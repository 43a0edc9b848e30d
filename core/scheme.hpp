// What a scheme is: a value with its parameters, able to bind itself to a problem that offers what it needs.
//   scheme.bind(problem, x) → stepper       constrained by the concept the scheme asks for; evaluates at x what the
//                                           first step re-uses (a force)
//   stepper.step(x, h) noexcept → Status    one attempt: x.q and x.p move by h; x.t is read, the clock is the driver's
//   stepper.work()                          what it cost so far, exactly
// A stepper is a value: copy it with the state to try a step and take it back. What it keeps between steps depends on
// the state alone, so steps from a copy have the same bits.
#pragma once

#include <algorithm>
#include <concepts>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/composition.hpp"
#include "core/describe.hpp"
#include "core/problem.hpp"
#include "core/status.hpp"

namespace least {

template <class S, class P, class X>
using StepperOf = decltype(std::declval<const S&>().bind(std::declval<const P&>(), std::declval<const X&>()));

/// S can run P on states X: derived by the compiler from what bind asks for.
template <class S, class P, class X = StateOf<P>>
concept SchemeFor = requires(StepperOf<S, P, X> stepper, X& x, const typename X::Time& h) {
  { stepper.step(x, h) }
  noexcept->std::same_as<Status>;
  { stepper.work() } -> std::convertible_to<Work>;
};

// A scheme may also say, as const members: objection(problem) → what it has against a scene, in words;
// flips_momentum(problem, t); starts_at_singularity(problem). See Engine.

/// What contact schemes with the factor 1/(1 + hα/2) have against αh: a stage of weight γ has a pole at γαh = −2.
std::string pole_objection(Composition composition, double damping_step);

/// The parameters that most schemes share.
template <class C>
constexpr Field<C> step_field() {
  return {"step", "h", "time", "length of a step", &C::step, {0, 1e3, true, false}, {}, "step"};
}
template <class C>
constexpr Field<C, Composition> composition_field() {
  return {"composition",      "", "", "symmetric composition that raises the order", &C::composition, {0, 0},
          compositions::names};
}

/// Orders by composition for a symmetric base: the composition's, or the base's own where that is higher.
inline std::vector<std::pair<std::string_view, int>> orders_from(int base) {
  std::vector<std::pair<std::string_view, int>> orders;
  for (std::size_t i = 0; i < compositions::names.size(); ++i)
    orders.emplace_back(compositions::names[i], std::max(base, compositions::orders[i]));
  return orders;
}

}  // namespace least
