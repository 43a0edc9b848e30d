// The structure a step keeps, measured by dual numbers: the tangent map M of one step and its defect MᵀJM − J, where
// J = (0 I; −I 0). Zero to round-off for a symplectic scheme.
// Source: Hairer, Lubich, Wanner 2006, VI.2.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/scheme.hpp"

namespace least {

/// M: derivatives of (q₁, p₁) with respect to (q₀, p₀) over one step from x. Empty where the step fails.
template <class Scheme, class P>
std::optional<Mat<2 * P::dof>> tangent_map(const Scheme& scheme, const P& problem, const StateOf<P>& x, double h) {
  constexpr int n = P::dof;
  using D = Dual<double, 2 * n>;
  StateOf<P, D> y;
  y.t = x.t;
  for (int i = 0; i < n; ++i) {
    y.q[std::size_t(i)] = D::variable(x.q[std::size_t(i)], i);
    y.p[std::size_t(i)] = D::variable(x.p[std::size_t(i)], n + i);
  }
  auto stepper = scheme.bind(problem, y);
  if (stepper.step(y, h) != Status::ok) return std::nullopt;
  Mat<2 * n> m;
  for (std::size_t i = 0; i < n; ++i) {
    m[i] = y.q[i].slope;
    m[n + i] = y.p[i].slope;
  }
  return m;
}

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

}  // namespace least
