// The structure a step keeps, measured by dual numbers: the tangent map M of one step, its defect MᵀJM − J where the
// scene is conservative, J = (0 I; −I 0), and where it has a contact form η = ds − p·dq the defect of φ*η = λη. Zero to
// round-off for a symplectic, for a contact scheme. Sources: Hairer, Lubich, Wanner 2006, VI.2; Vermeeren, Bravetti,
// Seri, J. Phys. A 52, 445206 (2019), section 2.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "core/scheme.hpp"

namespace least {

/// Where a step leads, and the derivatives of that by where it began, in the order of the components.
template <class X>
struct Tangent {
  X image;
  Mat<int(X::size)> m;
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

/// Of a step that a scheme takes from x in a run from `start`. Empty where the step fails.
template <class Scheme, class P, class X>
std::optional<Tangent<X>> step_tangent(const Scheme& scheme, const P& problem, const X& start, const X& x) {
  if constexpr (SelfTimed<Scheme>) {  // on the run's energy level
    return tangent_of(x, [&](auto& y) {
      using D = typename std::remove_cvref_t<decltype(y)>::Number;
      auto z = convert<D, D>(y);
      auto stepper = scheme.bind(problem, z, D(energy_level(scheme, problem, start)));
      const StepStatus status = stepper.step(z);
      y.t = z.t.value;
      for (std::size_t i = 0; i < X::size; ++i) y[i] = z[i];
      return status;
    });
  } else {
    return tangent_map(scheme, problem, x, scheme.step);
  }
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
  std::function<std::optional<Tangent<Full>>(const Full&)> plain;
  std::function<std::optional<ExtendedStepOf<P>>(const Full&)> extended;
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
