// A scheme is a value with its parameters that can bind itself to a problem which offers what the scheme needs.
//   scheme.bind(problem, x) → stepper           constrained by the concept that the scheme requires; evaluates at x
//   what
//                                               the first step re-uses (a force)
//   stepper.step(x, h) noexcept → StepStatus    one attempt to move x.q and x.p by a time h; reads x.t, but its caller
//                                               advances it. For a state in lanes it returns StatusOf<Number>, one
//                                               status for each lane
//   stepper.work()                              exact cost of all steps so far
// A stepper is a value: to undo a trial step, copy stepper and state first. The memory of a stepper between steps
// depends on the state alone, so steps of a copy have the same bits.
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

/// take writes the result `made` of a step to x; `good` is a mask of the lanes that did not fail, the others keep x.
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

/// OfRatesAlone: a step evaluates only the right side of the equations of motion, which is finite wherever they are
/// defined. Where H has γs²/2, such a step does not use the exact flow of s, so the pole of that flow does not matter
/// to it.
template <class S>
concept OfRatesAlone = requires {
  requires S::of_rates_alone;
};

template <class S, class P, class X>
using StepperOf = decltype(std::declval<const S&>().bind(std::declval<const P&>(), std::declval<const X&>()));

/// FixedStepSchemeFor: S can run P on states X, as the compiler derives from the constraints of bind.
template <class S, class P, class X = StateOf<P>>
concept FixedStepSchemeFor = requires(StepperOf<S, P, X> stepper, X& x, const typename X::Time& h) {
  { stepper.step(x, h) }
  noexcept->std::convertible_to<StatusOf<typename X::Number>>;
  { stepper.work() } -> std::convertible_to<Work>;
};

/// SelfTimed is a scheme that sets its own clock: a step moves x.t as well, by a time that the scheme chooses.
///   scheme.bind(problem, x, energy) → stepper   `energy` is the energy (or `level`) at the start of the run
///   stepper.step(x) noexcept → StepStatus           leaves x as it was where it fails
///   stepper.work()
///   stepper.active_method()                     optional: how the last step was taken
///   scheme.level(problem, x)                    optional: replaces H as the energy of a run from x
///   scheme.asks_no_level                        optional: `energy` is not used, and is 0
///   stepper.step_within(x, most) → StepStatus   optional: a step of a length of at most `most`, the last of a run. The
///                                               overload (x, most, late) is given the rounding error of x.t, positive
///                                               where x.t is too late
///   stepper.parts                               optional: number of parts of a step that a search for changes of sign
///                                               looks at one by one
///   stepper.reach(x, t) → StepStatus            optional: moves x to the time t, within one step from x, by a part of
///   a
///                                               step; without it, quintic Hermite interpolation gives states in a step
/// A step computes the time as well, so time is made of the same number as the state.
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

/// OnEquations: the scheme needs only the equations of motion recorded on a tape. It is therefore compiled once, for
/// the interface that a run has to every problem (core/catalogue/equation_steps.hpp).
template <class S>
concept OnEquations = SelfTimed<S> && requires {
  requires S::on_equations;
};

/// energy_level returns the energy that a run of a SelfTimed scheme from x starts with, or the scheme's own level in
/// its place; 0 where the scheme does not use one.
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

/// Mode says how a hybrid scheme took a step.
enum class Mode : std::uint8_t { hamilton, jacobi_maupertuis };
inline constexpr std::array<std::string_view, 2> mode_names{"hamilton", "jacobi_maupertuis"};
struct ActiveMethod {
  Mode mode = Mode::hamilton;
  int parameter = -1;  ///< index of the coordinate that is the parameter in jacobi_maupertuis
  friend constexpr bool operator==(const ActiveMethod&, const ActiveMethod&) = default;
};

// A scheme may also declare, as const members: unsupported_reason(problem) → why it does not take a scene, in words;
// flips_from() and stiff_from(problem) → the αh from which a step reverses the momentum, or no longer resolves the
// damping; starts_at_singularity(problem) → whether its step from rest at t = 0 holds although the equations of motion
// are singular there; and if it is variational, step_energy(problem, a, b, h) → the discrete energy of its step of
// length h from a to b without composition, see discrete_energy.

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

/// orders_from(base) returns the order of each composition of a symmetric scheme of order `base`: that of the
/// composition for a base of order 2, but at least `base`.
inline std::vector<std::pair<std::string, int>> orders_from(int base) {
  std::vector<std::pair<std::string, int>> orders;
  for (std::size_t i = 0; i < compositions::names.size(); ++i)
    orders.emplace_back(compositions::names[i], std::max(base, compositions::orders[i]));
  return orders;
}

}  // namespace least
