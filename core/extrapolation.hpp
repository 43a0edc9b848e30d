// The explicit midpoint rule, extrapolated to the precision of its number type. It gives the exact flow of equations of
// motion: in quad for reference solutions where there is no series, in double for the error of a single step of a
// scheme. Source: Gragg, SIAM J. Numer. Anal. 2, 384 (1965); Bulirsch & Stoer 1966; Hairer, Nørsett, Wanner, Solving
// Ordinary Differential Equations I, II.9.
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <utility>

#include "core/number/quad.hpp"
#include "core/problem_traits.hpp"

namespace least {

/// Extrapolation integrates the equations of motion by the explicit midpoint rule, extrapolated in h², with adaptive
/// order and step.
template <class P, class Y = StateOf<P, Quad, Quad>>
class Extrapolation {
 public:
  using X = Y;
  using T = typename X::Number;
  static constexpr std::size_t size = X::size;

  /// `tolerance` bounds the error of a step, relative to the largest component of the state or to that of the start x
  /// (at most 1), whichever is larger. `step` is the first step to be tried.
  Extrapolation(const P& problem, const X& x, double tolerance, T step = T(0.1))
      : problem_(problem), x_(x), tolerance_(tolerance), regular_(starts_series(problem, x)), step_(step) {
    using least::abs;
    T largest(0);
    for (std::size_t i = 0; i < size; ++i) largest = std::max(largest, T(abs(x[i])));
    if (largest > T(0) && largest < T(1)) least_size_ = largest;
  }

  /// PartOf(from, to) returns which fraction of the step may be taken. A step whose fraction is below 1 is repeated
  /// with that length; this bounds steps where the estimate of the error does not suffice.
  using PartOf = std::function<double(const X& from, const X& to)>;
  void bound_steps(PartOf part) { part_ = std::move(part); }

  const X& state() const { return x_; }

  /// Advances the state to t. Returns false if keep_going() does, or if the steps become too small to make progress.
  template <class KeepGoing>
  bool advance(const T& t, KeepGoing&& keep_going) {
    using least::abs;
    if constexpr (HasSeries<P>) {
      const T until(P::series_until);
      if (regular_ && x_.t < until) {
        x_.t = std::min(t, until);
        assign(x_, series_state<X>(problem_, x_.t));
      }
    }
    while (x_.t < t) {
      const T left = t - x_.t;
      const bool last = !(step_ < left);
      const T h = last ? left : step_;
      const int column = attempt(h);
      if (!last) short_ = h < T(tiny) * (x_.t - start_) ? short_ + 1 : 0;
      if (short_ > patience) return false;
      if (column < 0) {
        step_ = h / 4;
        if (!keep_going() || !(step_ > T(shortest) * (1 + abs(t)))) return false;
        continue;
      }
      X next = table_[static_cast<std::size_t>(column)];
      next.t = last ? t : x_.t + h;
      if (const T taken = part_ ? h * T(part_(x_, next)) : h; taken < h && taken > T(shortest) * (1 + abs(t))) {
        if (!keep_going()) return false;
        step_ = taken;
        continue;
      }
      x_ = next;
      // Early convergence says that a longer step would do, late convergence asks for a shorter one. A last step that
      // was cut to end at t never shortens the next.
      if (column < target) step_ = last ? std::max(step_, T(1.5) * h) : T(1.5) * h;
      if (column > target + 1) step_ = h * T(0.8);
      if (!keep_going()) return false;
    }
    return true;
  }

 private:
  static constexpr int columns = 15, target = 10;
  /// Near a time at which the motion ends, steps shrink without end: advance gives up after so many steps in a row
  /// shorter than `tiny` times the time integrated so far.
  static constexpr int patience = 1000;
  static constexpr double tiny = 1e-9;
  static constexpr double shortest = Precision<T>::epsilon < 1e-30 ? 1e-25 : 1e-12;  ///< step, relative to 1 + |t|

  /// attempt fills the diagonal of the extrapolation table until two neighbours agree; returns the column reached, or
  /// −1.
  int attempt(const T& h) {
    for (int j = 0; j < columns; ++j) {
      X next = midpoint(h, 2 * (j + 1));
      X coarse = next;
      for (int k = 1; k <= j; ++k) {  // Aitken–Neville, table_[k − 1] holding the row above
        const T ratio = T(j + 1) / T(j + 1 - k);
        const T w = 1 / (ratio * ratio - 1);
        X better = next;
        auto& above = table_[static_cast<std::size_t>(k - 1)];
        for (std::size_t i = 0; i < size; ++i) better[i] = next[i] + (next[i] - above[i]) * w;
        above = next;
        coarse = next;
        next = better;
      }
      table_[static_cast<std::size_t>(j)] = next;
      if (j > 1 && close(next, coarse)) return j;
    }
    return -1;
  }

  bool close(const X& a, const X& b) const {
    using least::abs;
    T difference(0), most = least_size_;
    for (std::size_t i = 0; i < size; ++i) {
      difference = difference + abs(a[i] - b[i]);
      most = std::max(most, abs(a[i]));
    }
    return difference < T(tolerance_) * most;  // false for NaN
  }

  X midpoint(const T& h, int n) const {
    const T d = h / n;
    X before = x_, now = shifted(x_, d, derivative(problem_, x_));
    now.t = x_.t + d;
    for (int m = 1; m < n; ++m) {
      X next = shifted(before, T(2) * d, derivative(problem_, now));
      next.t = x_.t + T(m + 1) * d;
      before = now;
      now = next;
    }
    const X end = shifted(before, d, derivative(problem_, now));  // Gragg's smoothing: the mean of now and end
    for (std::size_t i = 0; i < size; ++i) now[i] = (now[i] + end[i]) / 2;
    return now;
  }

  const P& problem_;
  X x_;
  double tolerance_;
  bool regular_;  ///< starts on the regular series from t = 0, where only the equations are singular
  T step_;
  PartOf part_;
  T start_ = x_.t;
  int short_ = 0;        ///< consecutive steps shorter than `tiny`, see `patience`
  T least_size_ = T(1);  ///< lower bound on the size that errors are relative to
  std::array<X, columns> table_{};
};

}  // namespace least
