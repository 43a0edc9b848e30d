// The length of a tangent in a norm that no unit enters: coordinates and velocities, each divided by the extent of the
// motion. Momenta would do only where masses are alike: two planets whose momenta are a millionth of their star's units
// seem to move apart without end. The extents are those of the true motion as far as a few steps of Dormand–Prince
// follow it from the start: they are the same for every scheme, and do not change on the way.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/number/linear.hpp"
#include "core/problem_traits.hpp"
#include "core/schemes/odeint.hpp"

namespace least {

template <class P>
class TangentLength {
 public:
  using X = StateOf<P>;
  static constexpr std::size_t size = X::size;
  using Direction = Vec<size>;

  /// Of the motion from x until `end`, or as far as a few steps go.
  TangentLength(const P& problem, const X& x, double end) {
    if constexpr (!Flow<P>) by_velocities_ = has_kinetic_matrix(problem, x);
    measure(problem, x, end);
    first_ = direction(problem, x);
    const double length = (*this)(problem, x, first_);
    for (double& component : first_) component /= length;
  }

  double operator()(const P& problem, const X& x, const Direction& u) const {
    double square = 0;
    const Direction seen = as_measured(problem, x, u);
    for (std::size_t i = 0; i < size; ++i) square += (seen[i] / extent_[i]) * (seen[i] / extent_[i]);
    return std::sqrt(square);
  }
  /// A tangent of length 1 at the start, in which no component that the scene has is left out, and none is as large as
  /// another.
  const Direction& first() const { return first_; }

 private:
  static constexpr std::size_t n = [] {
    if constexpr (Flow<P>) return size;
    if constexpr (!Flow<P>) return std::size_t(P::dof);
  }();

  /// q̇ of a state.
  template <class Y>
  static auto velocity_at(const P& problem, const Y& x) {
    if constexpr (Potential<P>) {
      return velocity(problem, x.q, x.p);
    } else {
      return problem.slopes(x.q, x.p, x.action.s, phase(problem, x.t)).by_p;
    }
  }
  /// The change of q̇ along a tangent.
  static Vec<n> velocity_slopes(const P& problem, const X& x, const Direction& u) {
    auto moved = convert<Slope, double>(x);
    for (std::size_t i = 0; i < size; ++i) moved[i].slope[0] = u[i];
    const auto v = velocity_at(problem, moved);
    Vec<n> slopes;
    for (std::size_t i = 0; i < n; ++i) slopes[i] = v[i].slope[0];
    return slopes;
  }
  /// ∂q̇/∂p, with units in the place of coordinates that the scene has not.
  static Mat<int(n)> inverse_masses(const P& problem, const X& x) {
    Mat<int(n)> inverse{};
    for (std::size_t j = 0; j < n; ++j) {
      Direction u{};
      u[n + j] = 1;
      const auto column = velocity_slopes(problem, x, u);
      for (std::size_t i = 0; i < n; ++i)
        inverse[i][j] = has_component(problem, i) && has_component(problem, j) ? column[i] : double(i == j);
    }
    return inverse;
  }
  /// Whether H is quadratic in p, or a Lagrangian says what velocities are.
  static bool has_kinetic_matrix([[maybe_unused]] const P& problem, [[maybe_unused]] const X& x) {
    if constexpr (GeneralHamiltonian<P> && !IteratesForRates<P>) {
      X other = x;
      for (std::size_t i = 0; i < n; ++i) other[n + i] = 1 + 2 * x[n + i];
      const auto here = inverse_masses(problem, x), there = inverse_masses(problem, other);
      double change = 0, most = 0;
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j) {
          change = std::max(change, std::abs(here[i][j] - there[i][j]));
          most = std::max(most, std::abs(here[i][j]));
        }
      const double determinant = least::determinant(here);
      return change <= 1e-9 * most && std::isfinite(determinant) && determinant != 0;
    }
    return true;
  }

  /// A state or a tangent as the norm reads it: with velocities in the place of momenta.
  Direction as_measured(const P& problem, const X& x, const Direction& u) const {
    Direction seen = u;
    if constexpr (!Flow<P>)
      if (by_velocities_) std::ranges::copy(velocity_slopes(problem, x, u), seen.begin() + n);
    return seen;
  }

  void measure(const P& problem, X x, double end) {
    constexpr int steps = 128;
    constexpr double tolerance = 1e-5;
    double most = 0;
    for (std::size_t i = 0; i < size; ++i) most = std::max(most, std::abs(x[i]));
    const double relative = most > 0 ? std::min(1.0, most) : 1;  // the tolerance of small states is one of their size
    auto stepper = AnyOdeintScheme{odeint::Method::dormand_prince_5, tolerance * relative}.bind(problem, x);
    std::optional<Direction> low, high;
    Direction largest{};
    const auto see = [&] {
      Direction seen;
      for (std::size_t i = 0; i < size; ++i) seen[i] = x[i];
      if constexpr (!Flow<P>)
        if (by_velocities_) std::ranges::copy(velocity_at(problem, x), seen.begin() + n);
      if (!std::ranges::all_of(seen, [](double component) { return std::isfinite(component); })) return false;
      if (!low) low = high = seen;
      for (std::size_t i = 0; i < size; ++i) {
        (*low)[i] = std::min((*low)[i], seen[i]);
        (*high)[i] = std::max((*high)[i], seen[i]);
        largest[i] = std::max(largest[i], std::abs(seen[i]));
      }
      return true;
    };
    for (int step = 0; see() && step < steps && x.t < end; ++step)
      if (stepper.step(x) != StepStatus::ok) break;
    for (std::size_t i = 0; i < size; ++i) {
      const double range = low ? (*high)[i] - (*low)[i] : 0, grain = 1e-12 * largest[i];
      const bool from_zero = !Flow<P> && n <= i && i < 2 * n;  // velocities and momenta have an origin, places have not
      extent_[i] = from_zero ? largest[i] : range > grain ? range : 0;
    }
    share(0, n, largest);
    if constexpr (!Flow<P>) share(n, 2 * n, largest);
    if constexpr (!Flow<P>)
      if constexpr (X::acting) share(2 * n, size, largest);
  }
  /// Extents that differ by less than a factor of 32 are taken for lengths in one unit, and the largest stands for all
  /// of them: else a plane would be measured otherwise when it is turned. What rests is measured as the others, and
  /// where all rest by where they are.
  void share(std::size_t begin, std::size_t end, const Direction& largest) {
    constexpr double alike = 32;
    const auto part = [&](auto& all) { return std::span(all).subspan(begin, end - begin); };
    const double all = std::ranges::max(part(extent_)), place = std::ranges::max(part(largest));
    const Direction own = extent_;
    double above = all > 0 ? all : place > 0 ? place : 1;
    for (double& extent : part(extent_))
      if (extent == 0) extent = above;
    for (double next = above; next > 0; above = next) {
      next = 0;
      for (std::size_t i = begin; i < end; ++i) {
        if (own[i] == 0 || own[i] > above) continue;
        if (own[i] * alike >= above)
          extent_[i] = above;
        else
          next = std::max(next, own[i]);
      }
    }
  }

  Direction direction(const P& problem, const X& x) {
    Direction u{};
    double count = 0;
    for (std::size_t i = 0; i < size; ++i)
      if (has_component(problem, i)) u[i] = extent_[i] * std::pow(++count, -2.0 / 3);
    if constexpr (!Flow<P>) {
      if (!by_velocities_) return u;
      Direction at_rest = u;  // without what momenta add to velocities
      for (std::size_t i = 0; i < n; ++i) at_rest[n + i] = 0;
      Vec<n> wanted, moved = velocity_slopes(problem, x, at_rest);
      for (std::size_t i = 0; i < n; ++i) wanted[i] = u[n + i] - moved[i];
      const Vec<n> momenta = LinearSolver<double>::solve(inverse_masses(problem, x), wanted);
      if (std::ranges::all_of(momenta, [](double p) { return std::isfinite(p); }))
        std::ranges::copy(momenta, u.begin() + n);
    }
    return u;
  }

  bool by_velocities_ = false;
  Direction extent_{}, first_{};
};

}  // namespace least
