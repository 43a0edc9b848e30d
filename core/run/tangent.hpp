// Tangents of single steps of a scheme on a problem, by dual numbers.
#pragma once

#include <optional>
#include <type_traits>

#include "core/problem_traits.hpp"
#include "core/run/tangent_map.hpp"
#include "core/scheme.hpp"

namespace least {

/// Where a step leads, and the derivatives of that by where it began, in the order of the components.
template <class X>
struct Tangent {
  X image;
  Mat<int(X::size)> m{};
};

/// The tangent of a map of states, `step(y)` in dual numbers, at x. It is taken along one direction at a time: numbers
/// with a slope for each direction are several times as much code for every scheme of every problem. Empty where a step
/// fails, or keep_going(), asked before each of them, says no.
template <class X, class Step>
std::optional<Tangent<X>> tangent_of(const X& x, const StepTangents::KeepGoing& keep_going, Step&& step) {
  Tangent<X> tangent;
  for (std::size_t j = 0; j < X::size; ++j) {
    if (!keep_going()) return std::nullopt;
    auto y = convert<Slope, double>(x);
    y[j] = Slope::variable(x[j], 0);
    if (step(y) != StepStatus::ok) return std::nullopt;
    tangent.image.t = y.t;
    for (std::size_t i = 0; i < X::size; ++i) {
      tangent.image[i] = y[i].value;
      tangent.m[i][j] = y[i].slope[0];
    }
  }
  return tangent;
}

/// A step on the extended space of a contact scene: where it began, and its tangent.
template <class Z>
struct ExtendedStep {
  Z start;
  Tangent<Z> tangent;
};
namespace detail {
template <class P>
struct ExtendedStepFor {
  struct type {};
};
template <LinearContact P>
struct ExtendedStepFor<P> {
  using type = ExtendedStep<Extended<P>>;
};
}  // namespace detail
/// Empty for a scene that has none.
template <class P>
using ExtendedStepOf = typename detail::ExtendedStepFor<P>::type;
template <class Scheme, class P>
concept ExtendsTo = LinearContact<P> && requires(const Scheme& scheme, const P& problem, Extended<P>& z) {
  scheme.step_extended(problem, z, 0.0);
};

/// What a step does depends on more than the state that it begins at.
template <class Scheme>
concept AdaptsSteps = requires {
  requires Scheme::reads_time;
}
|| requires { requires Scheme::remembers; };

/// Where a step leads, and how that changes along one direction.
template <class X>
struct StepChange {
  X image;
  Vec<int(X::size)> change;
  double longer = 0;      ///< by how much the step takes more time
  ActiveMethod course{};  ///< of a hybrid: how the step was taken
};

/// Of a step that a scheme takes from x in a run from `start`, after one that was taken in this way, where x changes by
/// u, the time by dt and the energy level by `level`: a scheme that sets its own clock may read them. Empty where the
/// step fails.
template <class Scheme, class P, class X>
std::optional<StepChange<X>> step_change(const Scheme& scheme, const P& problem, [[maybe_unused]] const X& start,
                                         const X& x, [[maybe_unused]] const ActiveMethod& before,
                                         const Vec<int(X::size)>& u, [[maybe_unused]] double dt,
                                         [[maybe_unused]] double level) {
  constexpr bool own_clock = SelfTimed<Scheme>;
  using Time = std::conditional_t<own_clock, Slope, double>;
  auto y = convert<Slope, Time>(x);
  for (std::size_t i = 0; i < X::size; ++i) y[i].slope[0] = u[i];
  StepChange<X> found;
  if constexpr (own_clock) {
    y.t.slope[0] = dt;
    auto stepper = scheme.bind(problem, y, Slope(energy_level(scheme, problem, start), {level}));
    if constexpr (requires { stepper.go_on(before); }) stepper.go_on(before);
    if (stepper.step(y) != StepStatus::ok) return std::nullopt;
    if constexpr (requires { stepper.active_method(); }) found.course = stepper.active_method();
    found.image.t = y.t.value;
    found.longer = y.t.slope[0] - dt;
  } else {
    auto stepper = scheme.bind(problem, y);
    if (stepper.step(y, scheme.step) != StepStatus::ok) return std::nullopt;
    found.image.t = x.t + scheme.step;
  }
  for (std::size_t i = 0; i < X::size; ++i) {
    found.image[i] = y[i].value;
    found.change[i] = y[i].slope[0];
  }
  return found;
}

/// The same along all directions, as the first of the steps of a run. Empty also where keep_going(), asked before each
/// of them, says no.
template <class Scheme, class P, class X>
std::optional<Tangent<X>> step_tangent(const Scheme& scheme, const P& problem, const X& start, const X& x,
                                       const StepTangents::KeepGoing& keep_going) {
  Tangent<X> tangent;
  for (std::size_t j = 0; j < X::size; ++j) {
    Vec<int(X::size)> u{};
    u[j] = tangent.m[j][j] = 1;
    if (!has_component(problem, j)) continue;
    if (!keep_going()) return std::nullopt;
    const auto found = step_change(scheme, problem, start, x, {}, u, 0, 0);
    if (!found) return std::nullopt;
    tangent.image = found->image;
    for (std::size_t i = 0; i < X::size; ++i) tangent.m[i][j] = found->change[i];
  }
  return tangent;
}

/// The tangent of a step on the extended space from p_t = −H, of steps that are contact maps there and not of the state
/// alone.
template <class Scheme, class P, class X>
requires ExtendsTo<Scheme, P> std::optional<ExtendedStepOf<P>> extended_step_tangent(
    const Scheme& scheme, const P& problem, const X& start, const X& x, const StepTangents::KeepGoing& keep_going) {
  Extended<P> z;
  constexpr std::size_t n = P::dof;
  for (std::size_t i = 0; i < n; ++i) {
    z.q[i] = x.q[i];
    z.p[i] = x.p[i];
  }
  z.q[n] = x.t;
  z.p[n] = -energy(problem, x);
  z.action = x.action;
  const auto tangent = tangent_of(z, keep_going, [&](auto& y) {
    using D = typename std::remove_cvref_t<decltype(y)>::Number;
    return scheme.step_extended(problem, y, D(energy_level(scheme, problem, start)));
  });
  if (!tangent) return std::nullopt;
  return ExtendedStepOf<P>{z, *tangent};
}

/// The derivatives of the energy level of a run by its start.
template <class Scheme, class P, class X>
Vec<int(X::size)> level_slopes(const Scheme& scheme, const P& problem, const X& start) {
  Vec<int(X::size)> slopes{};
  if constexpr (SelfTimed<Scheme>)
    for (std::size_t j = 0; j < X::size; ++j) {
      auto x = convert<Slope, Slope>(start);
      x[j].slope[0] = 1;
      slopes[j] = energy_level(scheme, problem, x).slope[0];
    }
  return slopes;
}

/// A tangent as numbers.
template <class X>
TangentMap tangent_map(const X& from, const Tangent<X>& tangent) {
  TangentMap map;
  if constexpr (requires { X::dof; }) map.dof = X::dof;
  map.from = run_state(from);
  map.to = run_state(tangent.image);
  map.m.resize(X::size * X::size);
  for (std::size_t i = 0; i < X::size; ++i)
    for (std::size_t j = 0; j < X::size; ++j) map.m[i * X::size + j] = tangent.m[i][j];
  return map;
}

}  // namespace least
