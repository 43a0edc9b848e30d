// Implicit steps: Newton's method with the Jacobian from dual numbers.
#pragma once

#include <cmath>
#include <limits>

#include "core/number/linear.hpp"
#include "core/status.hpp"

namespace least {

/// The change of a velocity that moves the positions q by a few units in their last place within a step h: a force that
/// varies with q is not known better, whatever the velocity. Infinite for h = 0.
template <std::size_t N, class T, class S>
T grain_of(const std::array<T, N>& q, const S& h) {
  using least::abs;
  T size(std::numeric_limits<double>::min());
  for (const T& c : q) size = size + 8 * Precision<T>::epsilon * abs(c);
  return size / abs(h);
}

/// Solves residual(x) = 0 from the guess x. residual takes and gives Vec<N, U> for any number U; `scale` is the size of
/// a solution's components and `grain` the size below which an update means nothing (see `grain_of`). Ends when the
/// update is below ε^¾·scale + grain, where the next one would be below round-off; derivatives that ride along have
/// converged with it. `evaluations`: force evaluations per residual. On failure x is not a solution.
template <int N, class T, class F>
StepStatus newton(Vec<N, T>& x, const T& scale, const T& grain, F&& residual, int evaluations, Work& work) {
  using least::abs;
  using least::any;
  using least::select;
  static constexpr int most_iterations = 50;
  const double tolerance = std::pow(Precision<T>::epsilon, 0.75);
  auto active = !(scale < scale);  // every lane; NOLINT(misc-redundant-expression)
  for (int k = 0; k < most_iterations; ++k) {
    Vec<N, Dual<T, N>> u;
    for (int i = 0; i < N; ++i) u[std::size_t(i)] = Dual<T, N>::variable(x[std::size_t(i)], i);
    const auto r = residual(u);
    Mat<N, T> jacobian;
    Vec<N, T> right;
    for (std::size_t i = 0; i < N; ++i) {
      jacobian[i] = r[i].slope;
      right[i] = r[i].value;
    }
    work.forces += evaluations;
    ++work.iterations;
    const Vec<N, T> update = LinearSolver<T>::solve(jacobian, right);
    T size = abs(update[0]);
    for (std::size_t i = 1; i < N; ++i) size = size + abs(update[i]);
    for (std::size_t i = 0; i < N; ++i) x[i] = select(active, x[i] - update[i], x[i]);
    active = active & !(size <= tolerance * scale + grain);
    if (!any(active)) return StepStatus::ok;
  }
  return StepStatus::solver_failed;
}

}  // namespace least
