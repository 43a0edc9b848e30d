// The discrete energy of a step of a variational scheme: E_d = −∂L_d/∂h at fixed ends (in a contact scene at fixed s as
// well), the mean of v·L_v − L over the nodes of the quadrature. It is computed on demand, from the state where the
// step began. Source: Marsden & West, Acta Numerica 10, 357 (2001), 4.
#pragma once

#include "core/problem_traits.hpp"
#include "core/scheme.hpp"

namespace least {

/// discrete_energy returns E_d of a step of length h from a. For a composition with weights γ_i, −∂/∂h of the sum of
/// the stages' discrete Lagrangians is Σγ_iE_i. Unknown where the scheme is not variational, or the step fails.
template <class Scheme, class P, class X>
double discrete_energy([[maybe_unused]] const Scheme& scheme, [[maybe_unused]] const P& problem,
                       [[maybe_unused]] const X& a, [[maybe_unused]] double h) {
  if constexpr (requires { scheme.step_energy(problem, a, a, h); }) {
    auto stage = scheme;
    const Weights<double>* weights = &Weights<double>::of(Composition::none);
    if constexpr (requires { scheme.composition; }) {
      stage.composition = Composition::none;
      weights = &Weights<double>::of(scheme.composition);
    }
    double sum = 0;
    X x = a;
    for (std::size_t i = 0; i < static_cast<std::size_t>(weights->stages); ++i) {
      X y = x;
      const double part = weights->gamma[i] * h;
      auto stepper = stage.bind(problem, x);
      if (stepper.step(y, part) != StepStatus::ok) return unknown;
      sum += weights->gamma[i] * stage.step_energy(problem, x, y, part);
      y.t = a.t + weights->end[i] * h;
      x = y;
    }
    return std::isfinite(sum) ? sum : unknown;
  } else {
    return unknown;
  }
}

}  // namespace least
