// Implicit steps: Newton's method with the Jacobian from dual numbers.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/number/linear.hpp"
#include "core/status.hpp"

namespace least {

/// grain_of returns the change of a velocity that moves the positions q by a few units in their last place within a
/// step h: where the force varies with q, no velocity can be found to better accuracy. Infinite for h = 0.
template <std::size_t N, class T, class S>
T grain_of(const std::array<T, N>& q, const S& h) {
  using least::abs;
  T size(std::numeric_limits<double>::min());
  for (const T& c : q) size = size + 8 * Precision<T>::epsilon * abs(c);
  return size / abs(h);
}

/// AllUnknowns selects all unknowns of a system.
struct AllUnknowns {};
/// SomeUnknowns selects the unknowns at the first `count` entries of `place`. A class of problem with room for more
/// coordinates than its scene has solves only for those that the scene has; the other unknowns keep their values.
template <int N>
struct SomeUnknowns {
  std::array<std::uint8_t, std::size_t(N)> place{};
  std::size_t count = 0;

  static constexpr SomeUnknowns all() {
    SomeUnknowns every;
    for (; every.count < std::size_t(N); ++every.count) every.place[every.count] = std::uint8_t(every.count);
    return every;
  }
};

/// unknowns_of selects the unknowns that the problem has. The N unknowns form blocks of `Width`, whose first P::dof
/// belong to one coordinate each; unknowns of coordinates that the problem does not have are left out.
template <int N, int Width, class P>
constexpr auto unknowns_of([[maybe_unused]] const P& problem) {
  if constexpr (requires { problem.coordinates(); }) {
    SomeUnknowns<N> some;
    for (std::size_t i = 0; i < std::size_t(N); ++i) {
      const std::size_t k = i % std::size_t(Width);
      if (k < problem.coordinates() || k >= std::size_t(P::dof)) some.place[some.count++] = std::uint8_t(i);
    }
    return some;
  } else {
    return AllUnknowns{};
  }
}

namespace detail {
template <class T>
inline constexpr bool carries_slopes = false;
template <class T, int K>
inline constexpr bool carries_slopes<Dual<T, K>> = true;

/// newton_update returns J⁻¹r(x), which a round of Newton's method subtracts from x; J is the Jacobian of the residual
/// r.
template <int N, class T, class F>
requires(!carries_slopes<T>) Vec<N, T> newton_update(const Vec<N, T>& x, AllUnknowns, F&& residual) {
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
/// The same for some of the unknowns, with a few columns of the Jacobian at a time. For numbers that carry slopes the
/// Jacobian is that of their values alone: one with slopes as well would be several times as much code.
template <int N, class T, class F>
Vec<N, T> newton_update(const Vec<N, T>& x, const SomeUnknowns<N>& some, F&& residual) {
  using Plain = typename Underlying<T>::type;
  static constexpr int columns = carries_slopes<T> ? 1 : N < 4 ? N : 4;
  using D = Dual<T, columns>;
  const auto plain = [](const auto& number) {
    if constexpr (carries_slopes<T>) {
      return number.value;
    } else {
      return number;
    }
  };
  const std::size_t count = some.count;
  std::array<Plain, std::size_t(N) * std::size_t(N)> jacobian, spoilt;  // NOLINT: written before they are read
  Vec<N, T> wrong{}, update{};
  for (std::size_t first = 0; first < count; first += columns) {
    Vec<N, D> u;
    for (std::size_t i = 0; i < std::size_t(N); ++i) u[i] = D(x[i]);
    const std::size_t here = std::min<std::size_t>(columns, count - first);
    for (std::size_t j = 0; j < here; ++j) u[some.place[first + j]].slope[j] = T(1);
    const auto r = residual(u);
    for (std::size_t i = 0; i < count; ++i) {
      const D& equation = r[some.place[i]];
      for (std::size_t j = 0; j < here; ++j) jacobian[i * count + first + j] = plain(equation.slope[j]);
      wrong[i] = equation.value;
    }
  }
  const auto solve = [&](auto part) {
    Vec<N, Plain> right{}, solution{};
    for (std::size_t i = 0; i < count; ++i) right[i] = part(wrong[i]);
    if (count == 1) {
      solution[0] = right[0] / jacobian[0];
    } else {
      std::copy_n(jacobian.begin(), count * count, spoilt.begin());
      solve_by_lu(count, spoilt.data(), right.data(), solution.data());
    }
    for (std::size_t i = 0; i < count; ++i) part(update[some.place[i]]) = solution[i];
  };
  if constexpr (carries_slopes<T>) {
    for (std::size_t k = 0; k < wrong[0].slope.size(); ++k)
      solve([k](auto& number) -> auto& { return number.slope[k]; });
    solve([](auto& number) -> auto& { return number.value; });
  } else {
    solve([](auto& number) -> auto& { return number; });
  }
  return update;
}
template <int N, class T, class F>
requires(carries_slopes<T>) Vec<N, T> newton_update(const Vec<N, T>& x, AllUnknowns, F&& residual) {
  return newton_update<N>(x, SomeUnknowns<N>::all(), residual);
}
}  // namespace detail

/// newton solves residual(x) = 0 from the guess x. `residual` takes and returns Vec<N, U> for any number U; `scale` is
/// the size of a solution's components and `grain` the size below which an update is only round-off (see `grain_of`).
/// It ends when the update is below ε^¾·scale + grain, since the next one would be below round-off, and one round later
/// for derivatives in dual numbers, which converge a round later. `evaluations`: force evaluations per residual. On
/// failure x is not a solution.
template <int N, class T, class F, class Unknowns>
StepStatus newton(Vec<N, T>& x, const Unknowns& unknowns, const T& scale, const T& grain, F&& residual, int evaluations,
                  Work& work) {
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
    const Vec<N, T> update = detail::newton_update<N>(x, unknowns, residual);
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
