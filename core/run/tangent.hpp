// The structure a step keeps, measured by dual numbers: the tangent map M of one step, its defect MᵀJM − J where the
// scene is conservative, J = (0 I; −I 0), and where it has a contact form η = ds − p·dq the defect of φ*η = λη. Zero to
// round-off for a symplectic, for a contact scheme. Sources: Hairer, Lubich, Wanner 2006, VI.2; Vermeeren, Bravetti,
// Seri, J. Phys. A 52, 445206 (2019), section 2.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include "core/scheme.hpp"

namespace least {

/// Where a step leads, and the derivatives of that by where it began, in the order of the components. A scheme that
/// sets its own clock reaches states that lie near each other at different times, and its steps read the energy level
/// of the run and may read the time: the other derivatives belong to it. Those of steps of equal length are zero.
template <class X>
struct Tangent {
  X image;
  Mat<int(X::size)> m;
  Vec<int(X::size)> by_time{}, by_level{};  ///< of the image
  Vec<int(X::size)> duration{};             ///< of the time that the step takes
  double duration_by_time = 0, duration_by_level = 0;
  ActiveMethod course{};  ///< of a hybrid: how the step was taken
};

/// Of a map of states, `step(y)` in any number, from x. Empty where it fails.
template <class X, class Step>
std::optional<Tangent<X>> tangent_of(const X& x, Step&& step) {
  using D = Dual<double, int(X::size)>;
  auto y = convert<D, double>(x);
  for (std::size_t i = 0; i < X::size; ++i) y[i] = D::variable(x[i], int(i));
  if (step(y) != StepStatus::ok) return std::nullopt;
  Tangent<X> tangent;
  tangent.image.t = y.t;
  for (std::size_t i = 0; i < X::size; ++i) {
    tangent.image[i] = y[i].value;
    tangent.m[i] = y[i].slope;
  }
  return tangent;
}
template <class Scheme, class P, class X>
std::optional<Tangent<X>> tangent_map(const Scheme& scheme, const P& problem, const X& x, double h) {
  return tangent_of(x, [&](auto& y) {
    auto stepper = scheme.bind(problem, y);
    const StepStatus status = stepper.step(y, h);
    y.t = x.t + h;
    return status;
  });
}

/// A step on the extended space of a contact scene: where it began, and its tangent.
template <class Z>
struct StepTangent {
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
  using type = StepTangent<Extended<P>>;
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

/// Of schemes that set their own clock: the directions are those of the state, the energy level and, where the
/// equations read it, the time.
template <class P, class X>
using TimedDual = Dual<double, int(X::size) + (Autonomous<P> ? 1 : 2)>;

/// Of a step that a scheme takes from x in a run from `start`, after one that was taken in this way. Empty where the
/// step fails.
template <class Scheme, class P, class X>
std::optional<Tangent<X>> step_tangent(const Scheme& scheme, const P& problem, const X& start, const X& x,
                                       [[maybe_unused]] const ActiveMethod& before = {}) {
  if constexpr (SelfTimed<Scheme>) {
    constexpr bool timed = !Autonomous<P>;
    constexpr std::size_t n = X::size;
    using D = TimedDual<P, X>;
    auto y = convert<D, D>(x);
    for (std::size_t i = 0; i < n; ++i) y[i] = D::variable(x[i], int(i));
    if constexpr (timed) y.t = D::variable(x.t, int(n) + 1);
    auto stepper = scheme.bind(problem, y, D::variable(energy_level(scheme, problem, start), int(n)));
    if constexpr (requires { stepper.go_on(before); }) stepper.go_on(before);
    if (stepper.step(y) != StepStatus::ok) return std::nullopt;
    Tangent<X> tangent;
    if constexpr (requires { stepper.active_method(); }) tangent.course = stepper.active_method();
    tangent.image.t = y.t.value;
    for (std::size_t i = 0; i < n; ++i) {
      tangent.image[i] = y[i].value;
      std::copy_n(y[i].slope.begin(), n, tangent.m[i].begin());
      tangent.by_level[i] = y[i].slope[n];
      if constexpr (timed) tangent.by_time[i] = y[i].slope[n + 1];
    }
    std::copy_n(y.t.slope.begin(), n, tangent.duration.begin());
    tangent.duration_by_level = y.t.slope[n];
    if constexpr (timed) tangent.duration_by_time = y.t.slope[n + 1] - 1;
    return tangent;
  } else {
    return tangent_map(scheme, problem, x, scheme.step);
  }
}
/// The derivatives of the energy level of a run by its start.
template <class Scheme, class P, class X>
Vec<int(X::size)> level_slopes(const Scheme& scheme, const P& problem, const X& start) {
  Vec<int(X::size)> slopes{};
  if constexpr (SelfTimed<Scheme>) {
    using D = TimedDual<P, X>;
    auto x = convert<D, D>(start);
    for (std::size_t i = 0; i < X::size; ++i) x[i] = D::variable(start[i], int(i));
    const D level = energy_level(scheme, problem, x);
    std::copy_n(level.slope.begin(), X::size, slopes.begin());
  }
  return slopes;
}
/// The same on the extended space from p_t = −H, of steps that are contact maps there and not of the state alone.
template <class Scheme, class P, class X>
requires ExtendsTo<Scheme, P> std::optional<ExtendedStepOf<P>> extended_step_tangent(const Scheme& scheme,
                                                                                     const P& problem, const X& start,
                                                                                     const X& x) {
  Extended<P> z;
  constexpr std::size_t n = P::dof;
  for (std::size_t i = 0; i < n; ++i) {
    z.q[i] = x.q[i];
    z.p[i] = x.p[i];
  }
  z.q[n] = x.t;
  z.p[n] = -energy(problem, x);
  z.action = x.action;
  const auto tangent = tangent_of(z, [&](auto& y) {
    using D = typename std::remove_cvref_t<decltype(y)>::Number;
    return scheme.step_extended(problem, y, D(energy_level(scheme, problem, start)));
  });
  if (!tangent) return std::nullopt;
  return ExtendedStepOf<P>{z, *tangent};
}

/// Both, of a run.
template <class P>
struct StepTangents {
  using Full = FullStateOf<P>;
  std::function<std::optional<Tangent<Full>>(const Full&, const ActiveMethod& before)> plain;
  std::function<std::optional<ExtendedStepOf<P>>(const Full&)> extended;
  Vec<int(Full::size)> level{};  ///< the derivatives of the energy level of the run by its start
  double end = std::numeric_limits<double>::infinity();  ///< of the run, where it is known beforehand
};

/// max |MᵀJM − J| over its entries.
template <std::size_t M>
double symplectic_defect(const std::array<std::array<double, M>, M>& m) {
  constexpr std::size_t n = M / 2;
  double most = 0;
  for (std::size_t a = 0; a < M; ++a)
    for (std::size_t b = 0; b < M; ++b) {
      double sum = a + n == b ? -1 : (b + n == a ? 1 : 0);
      for (std::size_t i = 0; i < n; ++i) sum += m[i][a] * m[n + i][b] - m[n + i][a] * m[i][b];
      most = std::isnan(sum) ? sum : std::max(most, std::abs(sum));
    }
  return most;
}

struct ContactDefect {
  double defect;  ///< max |φ*η − λη| over dq, dp, ds
  double factor;  ///< λ, read off ds
};
/// For a map of (q, p, s) that begins at x.
template <class X>
requires X::acting ContactDefect contact_defect(const X& x, const Tangent<X>& tangent) {
  constexpr std::size_t n = X::dof, s = 2 * n;
  const auto pulled = [&](std::size_t j) {  // φ*η along the j-th direction
    double sum = tangent.m[s][j];
    for (std::size_t i = 0; i < n; ++i) sum -= tangent.image.p[i] * tangent.m[i][j];
    return sum;
  };
  const double factor = pulled(s);
  double most = 0;
  for (std::size_t j = 0; j < s; ++j) {
    const double wrong = pulled(j) + (j < n ? factor * x.p[j] : 0.0);
    most = std::isnan(wrong) ? wrong : std::max(most, std::abs(wrong));
  }
  return {most, factor};
}

}  // namespace least
