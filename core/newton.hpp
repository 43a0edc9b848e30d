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

namespace detail {
template <class T>
inline constexpr bool carries_slopes = false;
template <class T, int K>
inline constexpr bool carries_slopes<Dual<T, K>> = true;

/// One round of Newton's method: by how much x is off.
template <int N, class T, class F>
requires(!carries_slopes<T>) Vec<N, T> newton_update(const Vec<N, T>& x, F&& residual) {
  Vec<N, Dual<T, N>> u;
  for (int i = 0; i < N; ++i) u[std::size_t(i)] = Dual<T, N>::variable(x[std::size_t(i)], i);
  const auto r = residual(u);
  Mat<N, T> jacobian;
  Vec<N, T> right;
  for (std::size_t i = 0; i < N; ++i) {
    jacobian[i] = r[i].slope;
    right[i] = r[i].value;
  }
  return LinearSolver<T>::solve(jacobian, right);
}
/// The same in numbers that carry slopes, with a Jacobian of their values alone, a column at a time: a Jacobian that
/// carries slopes as well is several times as much code.
template <int N, class T, int K, class F>
Vec<N, Dual<T, K>> newton_update(const Vec<N, Dual<T, K>>& x, F&& residual) {
  using D = Dual<T, K>;
  Mat<N, T> jacobian;
  Vec<N, D> wrong, update;
  for (std::size_t j = 0; j < N; ++j) {
    Vec<N, Dual<D, 1>> u;
    for (std::size_t i = 0; i < N; ++i) u[i] = Dual<D, 1>(x[i]);
    u[j].slope[0] = D(1);
    const auto r = residual(u);
    for (std::size_t i = 0; i < N; ++i) {
      jacobian[i][j] = r[i].slope[0].value;
      wrong[i] = r[i].value;
    }
  }
  for (std::size_t k = 0; k <= K; ++k) {
    const auto part = [k](auto& number) -> auto& { return k < K ? number.slope[k] : number.value; };
    Vec<N, T> right;
    for (std::size_t i = 0; i < N; ++i) right[i] = part(wrong[i]);
    const Vec<N, T> solution = LinearSolver<T>::solve(jacobian, right);
    for (std::size_t i = 0; i < N; ++i) part(update[i]) = solution[i];
  }
  return update;
}
}  // namespace detail

/// Solves residual(x) = 0 from the guess x. residual takes and gives Vec<N, U> for any number U; `scale` is the size of
/// a solution's components and `grain` the size below which an update means nothing (see `grain_of`). Ends when the
/// update is below ε^¾·scale + grain, where the next one would be below round-off; derivatives that ride along converge
/// a round later. `evaluations`: force evaluations per residual. On failure x is not a solution.
template <int N, class T, class F>
StepStatus newton(Vec<N, T>& x, const T& scale, const T& grain, F&& residual, int evaluations, Work& work) {
  using least::abs;
  using least::any;
  using least::select;
  static constexpr int most_iterations = 50;
  const double tolerance = std::pow(Precision<T>::epsilon, 0.75);
  const auto every_lane = !(scale < scale);  // NOLINT(misc-redundant-expression)
  auto active = every_lane;
  bool slopes_lag = detail::carries_slopes<T>;
  for (int k = 0; k < most_iterations; ++k) {
    work.forces += evaluations;
    ++work.iterations;
    const Vec<N, T> update = detail::newton_update<N>(x, residual);
    T size = abs(update[0]);
    for (std::size_t i = 1; i < N; ++i) size = size + abs(update[i]);
    for (std::size_t i = 0; i < N; ++i) x[i] = select(active, x[i] - update[i], x[i]);
    active = active & !(size <= tolerance * scale + grain);
    if (any(active)) continue;
    if (!slopes_lag) return StepStatus::ok;
    slopes_lag = false;
    active = every_lane;
  }
  return StepStatus::solver_failed;
}

}  // namespace least
