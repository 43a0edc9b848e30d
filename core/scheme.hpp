// What a scheme is: a value with its parameters, able to bind itself to a problem that offers what it needs.
//   scheme.bind(problem, x) → stepper       constrained by the concept the scheme asks for; evaluates at x what the
//                                           first step re-uses (a force)
//   stepper.step(x, h) noexcept → StepStatus    one attempt: x.q and x.p move by h; x.t is read, the clock is the
//   driver's;
//                                           of a state in lanes StatusOf<Number>, one for each lane
//   stepper.work()                          what it cost so far, exactly
// A stepper is a value: copy it with the state to try a step and take it back. What it keeps between steps depends on
// the state alone, so steps from a copy have the same bits.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/composition.hpp"
#include "core/describe.hpp"
#include "core/equations.hpp"
#include "core/status.hpp"

namespace least {

template <class T, int K>
struct StatusFor<Dual<T, K>> : StatusFor<T> {};

/// Ends a step of which something went well: what it made replaces what was there, except in lanes that failed.
template <class X, class M>
constexpr void take(X& x, const X& made, const M& good) {
  if constexpr (std::is_same_v<M, bool>) {
    x = made;
  } else {
    for (std::size_t i = 0; i < X::size; ++i) x[i] = select(good, made[i], x[i]);
  }
}
template <class T, std::size_t N, class M>
constexpr void take(std::array<T, N>& x, const std::array<T, N>& made, const M& good) {
  for (std::size_t i = 0; i < N; ++i) x[i] = select(good, made[i], x[i]);
}

/// Needs rates alone, which are numbers wherever the equations of motion are: where H has γs²/2 such a step has no flow
/// of s in it, and so not the pole of that flow.
template <class S>
concept OfRatesAlone = requires {
  requires S::of_rates_alone;
};

template <class S, class P, class X>
using StepperOf = decltype(std::declval<const S&>().bind(std::declval<const P&>(), std::declval<const X&>()));

/// S can run P on states X: derived by the compiler from what bind asks for.
template <class S, class P, class X = StateOf<P>>
concept FixedStepSchemeFor = requires(StepperOf<S, P, X> stepper, X& x, const typename X::Time& h) {
  { stepper.step(x, h) }
  noexcept->std::convertible_to<StatusOf<typename X::Number>>;
  { stepper.work() } -> std::convertible_to<Work>;
};

/// A scheme that sets its own clock: a step moves x.t as well, by what the scheme finds right.
///   scheme.bind(problem, x, energy) → stepper   `energy` is the level that the run began with
///   stepper.step(x) noexcept → StepStatus           leaves x as it was where it fails
///   stepper.work()
///   stepper.active_method()                     optional: how the last step was taken
///   scheme.level(problem, x)                    optional: what stands for the energy of a run from x instead of H
///   scheme.asks_no_level                        optional: `energy` is of no use to it, and is 0
///   stepper.step_within(x, most) → StepStatus   optional: a step that is at most so long; such a run ends with it. As
///                                               (x, most, late) it is told by how much rounding has made x.t too late
///   stepper.parts                               optional: into so many parts a step is divided by whoever looks for
///                                               changes of sign
///   stepper.reach(x, t) → StepStatus            optional: x moved to the time t, which lies within one step from x,
///                                               by a part of a step; else quintic Hermite interpolation fills in
/// Time is part of what a step computes, so it is made of the same number as the state.
template <class S>
concept SelfTimed = requires {
  requires S::own_clock;
};
template <class S, class P, class X>
using SelfTimedStepperOf = decltype(std::declval<const S&>().bind(std::declval<const P&>(), std::declval<const X&>(),
                                                                  std::declval<const typename X::Number&>()));
template <class S, class P, class X = StateOf<P>>
concept SelfTimedSchemeFor = SelfTimed<S> && requires(SelfTimedStepperOf<S, P, X> stepper, X& x) {
  { stepper.step(x) }
  noexcept->std::same_as<StepStatus>;
  { stepper.work() } -> std::convertible_to<Work>;
};

/// A scheme that needs equations of motion as they are written on a tape and nothing else: bound to what a run asks of
/// any problem (core/catalogue/equation_steps.hpp), it is compiled once for all.
template <class S>
concept OnEquations = SelfTimed<S> && requires {
  requires S::on_equations;
};

/// The energy that such a run from x begins with, or what the scheme puts in its place; of a scene whose schemes do not
/// ask for it nothing.
template <class S, class P, class X>
auto energy_level([[maybe_unused]] const S& scheme, [[maybe_unused]] const P& problem, [[maybe_unused]] const X& x) {
  constexpr bool asked = !requires { requires S::asks_no_level; };
  if constexpr (requires { scheme.level(problem, x); }) {
    return scheme.level(problem, x);
  } else if constexpr (asked && Conservative<P>) {
    return energy(problem, x);
  } else if constexpr (asked && LinearContact<P>) {
    return mechanical_energy(problem, x.q, x.p, phase(problem, x.t));
  } else {
    return 0.0;
  }
}

/// How a step of a hybrid was taken.
enum class Mode : std::uint8_t { hamilton, jacobi_maupertuis };
inline constexpr std::array<std::string_view, 2> mode_names{"hamilton", "jacobi_maupertuis"};
struct ActiveMethod {
  Mode mode = Mode::hamilton;
  int parameter = -1;  ///< which coordinate is the parameter in jacobi_maupertuis
  friend constexpr bool operator==(const ActiveMethod&, const ActiveMethod&) = default;
};

// A scheme may also say, as const members: unsupported_reason(problem) → what it has against a scene, in words;
// flips_from() and stiff_from(problem) → the αh from which a step turns the momentum over, or no longer resolves the
// damping; starts_at_singularity(problem), see Integrator; and if it is variational, of its step of length h from a to
// b without composition, step_energy(problem, a, b, h) → its discrete energy, see discrete_energy.

/// The parameters that most schemes share.
template <class C>
constexpr Field<C> step_field() {
  return {"step", "h", "time", "length of a step", &C::step, any_length, {}, "step"};
}
template <class C>
constexpr Field<C, Composition> composition_field() {
  return {"composition",      "", "", "raises the order: a symmetric one, or its weights", &C::composition, {0, 0},
          compositions::names};
}

/// Orders by composition for a symmetric base: the composition's, or the base's own where that is higher.
inline std::vector<std::pair<std::string, int>> orders_from(int base) {
  std::vector<std::pair<std::string, int>> orders;
  for (std::size_t i = 0; i < compositions::names.size(); ++i)
    orders.emplace_back(compositions::names[i], std::max(base, compositions::orders[i]));
  return orders;
}

}  // namespace least
