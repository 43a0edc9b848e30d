// Tangents of single steps of a scheme on a problem, by dual numbers.
#pragma once

#include <optional>
#include <type_traits>

#include "core/problem_traits.hpp"
#include "core/run/tangent_map.hpp"
#include "core/scheme.hpp"

namespace least {

/// Tangent is the image of a state under a step, and the matrix m[i][j] = ∂image_i/∂x_j in the order of the components.
template <class X>
struct Tangent {
  X image;
  Mat<int(X::size)> m{};
};

/// tangent_of returns the tangent at x of a map of states, `step(y)` in dual numbers. It takes one direction at a time:
/// numbers with a slope for each direction would be several times as much code for every scheme of every problem. Empty
/// if a step fails, or keep_going(), called before each direction, returns false.
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

/// ExtendedStep is a step on the extended space of a contact scene: its start, and its tangent.
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
/// ExtendedStepOf is an empty struct for a scene without an extended space.
template <class P>
using ExtendedStepOf = typename detail::ExtendedStepFor<P>::type;
template <class Scheme, class P>
concept ExtendsTo = LinearContact<P> && requires(const Scheme& scheme, const P& problem, Extended<P>& z) {
  scheme.step_extended(problem, z, 0.0);
};

/// AdaptsSteps: a step depends on more than the state at which it begins.
template <class Scheme>
concept AdaptsSteps = requires {
  requires Scheme::reads_time;
}
|| requires { requires Scheme::remembers; };

/// StepChange is the image of a state under a step, and the derivative of the image along one direction.
template <class X>
struct StepChange {
  X image;
  Vec<int(X::size)> change;
  double longer = 0;      ///< derivative of the length of the step
  ActiveMethod course{};  ///< how a hybrid took the step
};

/// step_change returns the change of a step from x in a run from `start`, after a step by the method `before`, where x
/// changes by u, the time by dt and the energy level by `level` (a scheme that sets its own clock may use the last
/// three). Empty if the step fails.
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

/// step_tangent returns the same along all directions, for x as the first state of a run. Empty also if keep_going(),
/// called before each direction, returns false.
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

/// extended_step_tangent returns the tangent of a step on the extended space from p_t = −H, for steps that are contact
/// maps on that space but not on the state alone.
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

/// level_slopes returns the derivatives of the energy level of a run with respect to the components of its start.
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

/// tangent_map converts a tangent to plain numbers.
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
