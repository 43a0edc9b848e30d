// A motion and its derivative in one direction of the start, by dual numbers through the classical Runge–Kutta scheme
// with steps halved for comparison (Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, II.4).
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/problem_traits.hpp"
#include "core/run/mechanics.hpp"
#include "core/run/steep_steps.hpp"
#include "core/schemes/runge_kutta.hpp"

namespace least {

template <std::size_t N>
Vec<N> unit(std::size_t direction) {
  Vec<N> u{};
  u[direction] = 1;
  return u;
}

/// Follows a motion and its derivative in one direction of the start.
template <class P>
class Differences {
 public:
  using D = Dual<double, 1>;
  using X = StateOf<P, D, D>;

  /// `direction`: in the order of the components. `tolerance`: of a step, relative to the largest component of the
  /// state and of the derivative. `step`: the first to be tried; none: a hundredth of the way.
  Differences(const P& problem, const StateOf<P>& x, const Vec<X::size>& direction, double end, double tolerance,
              std::optional<double> step = {})
      : problem_(problem),
        steep_(problem),
        x_(convert<D, D>(x)),
        end_(end),
        scale_(largest(x_).first),
        tolerance_(tolerance),
        step_(step.value_or((end - x.t) / 100)) {
    for (std::size_t i = 0; i < X::size; ++i) x_[i].slope[0] = direction[i];
  }

  StateOf<P> state() const { return plain(x_); }
  Vec<X::size> derivative() const {
    Vec<X::size> u;
    for (std::size_t i = 0; i < X::size; ++i) u[i] = x_[i].slope[0];
    return u;
  }
  double time() const { return x_.t.value; }
  double growth() const {
    const auto [value, slope] = largest(x_);
    return slope * scale_ / std::max(1.0, value);
  }

  /// Whether the last trial came to a place outside of the domain.
  bool left_domain() const { return HasDomain<P> && left_domain_; }

  /// One step that is accurate enough. False: the motion ends here.
  bool advance() {
    const double shortest = 1e-13 * std::max(std::abs(time()), end_ - time());
    for (;;) {
      const double left = end_ - time(), h = std::min(step_, left);
      X whole = x_, halves = x_;
      move(whole, h);
      move(halves, h / 2);
      halves.t = x_.t + h / 2;
      move(halves, h / 2);
      const auto [value, slope] = largest(halves);
      double error = 0;
      for (std::size_t i = 0; i < X::size; ++i) {
        error = larger(error, std::abs(whole[i].value - halves[i].value) / value);
        error = larger(error, std::abs(whole[i].slope[0] - halves[i].slope[0]) / slope);
      }
      error /= 15 * tolerance_;
      if (error <= 1 && inside(halves)) {
        halves.t = D(h < left ? time() + h : end_);
        if (const double part = steep_.resolved_part(state(), plain(halves), tolerance_);
            part < 1 && part * h > shortest) {
          step_ = part * h;
          continue;
        }
        x_ = halves;
        step_ = h * std::min(4.0, 0.9 / std::pow(std::max(error, 1e-6), 0.2));
        return true;
      }
      left_domain_ = error <= 1;
      step_ = error > 1 ? h * std::max(0.2, 0.9 / std::pow(error, 0.2)) : h / 4;  // NaN: a quarter
      if (step_ < (left_domain_ ? 1e-3 * left : shortest)) return false;
    }
  }

 private:
  static StateOf<P> plain(const X& x) {
    StateOf<P> y;
    y.t = x.t.value;
    for (std::size_t i = 0; i < X::size; ++i) y[i] = x[i].value;
    return y;
  }
  /// NaN stays.
  static double larger(double most, double x) { return std::isnan(most) || x <= most ? most : x; }
  void move(X& x, double h) { RungeKutta4{}.bind(problem_, x).step(x, D(h)); }
  bool inside(const X& x) const {
    if constexpr (HasDomain<P>) return !problem_.bounded() || problem_.inside(position(x)) >= D(0);
    return std::isfinite(x[0].value);
  }
  static std::pair<double, double> largest(const X& x) {
    double value = 1e-300, slope = 1e-300;  // divisors
    for (std::size_t i = 0; i < X::size; ++i) {
      value = std::max(value, std::abs(x[i].value));
      slope = std::max(slope, std::abs(x[i].slope[0]));
    }
    return {value, slope};
  }

  const P& problem_;
  SteepSteps<P> steep_;
  X x_;
  double end_, scale_, tolerance_, step_;
  bool left_domain_ = false;
};

}  // namespace least
