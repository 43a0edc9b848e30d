// Reference solutions: the closed form where a problem has one, else the problem's own equations of motion integrated
// in quad precision by extrapolation of the explicit midpoint rule at two tolerances, whose difference is the
// uncertainty. Source: Gragg, SIAM J. Numer. Anal. 2, 384 (1965); Bulirsch & Stoer 1966; Hairer, Nørsett, Wanner,
// Solving Ordinary Differential Equations I, II.9.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <vector>

#include "core/number/quad.hpp"
#include "core/problem_traits.hpp"
#include "core/run/mechanics.hpp"
#include "core/state_error.hpp"

namespace least {

template <class P>
struct Reference {
  std::vector<StateOf<P>> states;  ///< at the times asked for, rounded to double
  double uncertainty = 0x1p-53;    ///< in the measure of state_error
  std::string_view how = "closed form";
  bool complete = true;  ///< false: it was told to give up, or the solution ceased to be finite
};

/// The explicit midpoint rule extrapolated in h², order and step chosen as it goes.
template <class P, class Y = StateOf<P, Quad, Quad>>
class Extrapolation {
 public:
  using X = Y;
  static constexpr std::size_t size = X::size;

  Extrapolation(const P& problem, const X& x, double tolerance)
      : problem_(problem), x_(x), tolerance_(tolerance), regular_(starts_series(problem, x)) {}

  const X& state() const { return x_; }

  /// Moves on to t. False where keep_going() says so or the steps become too small.
  template <class KeepGoing>
  bool advance(const Quad& t, KeepGoing&& keep_going) {
    if constexpr (HasSeries<P>) {
      const Quad until(P::series_until);
      if (regular_ && x_.t < until) {
        x_.t = std::min(t, until);
        assign(x_, series_state<X>(problem_, x_.t));
      }
    }
    while (x_.t < t) {
      const Quad left = t - x_.t;
      const bool last = !(step_ < left);
      const Quad h = last ? left : step_;
      const int column = attempt(h);
      if (column < 0) {
        step_ = h / 4;
        if (!keep_going() || !(step_ > Quad(1e-25) * (1 + least::select(t < Quad(0), -t, t)))) return false;
        continue;
      }
      const Quad reached = last ? t : x_.t + h;
      x_ = table_[static_cast<std::size_t>(column)];
      x_.t = reached;
      // Converged early: the step was short. Late: long. A step cut to fit says little.
      if (column < target) step_ = last ? std::max(step_, Quad(1.5) * h) : Quad(1.5) * h;
      if (column > target + 1) step_ = h * Quad(0.8);
      if (!keep_going()) return false;
    }
    return true;
  }

 private:
  static constexpr int columns = 15, target = 10;

  /// Fills the diagonal of the extrapolation table until two neighbours agree; the column reached, or −1.
  int attempt(const Quad& h) {
    for (int j = 0; j < columns; ++j) {
      X next = midpoint(h, 2 * (j + 1));
      X coarse = next;
      for (int k = 1; k <= j; ++k) {  // Aitken–Neville, table_[k − 1] holding the row above
        const Quad ratio = Quad(j + 1) / Quad(j + 1 - k);
        const Quad w = 1 / (ratio * ratio - 1);
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
    Quad difference(0), most(1);
    for (std::size_t i = 0; i < size; ++i) {
      difference = difference + abs(a[i] - b[i]);
      most = std::max(most, abs(a[i]));
    }
    return difference < Quad(tolerance_) * most;  // false for NaN
  }

  X midpoint(const Quad& h, int n) const {
    const Quad d = h / n;
    X before = x_, now = shifted(x_, d, derivative(problem_, x_));
    now.t = x_.t + d;
    for (int m = 1; m < n; ++m) {
      X next = shifted(before, Quad(2) * d, derivative(problem_, now));
      next.t = x_.t + Quad(m + 1) * d;
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
  bool regular_;  ///< from t = 0, where the equations of motion are singular and the solution is not
  Quad step_ = Quad(0.1);
  std::array<X, columns> table_{};
};

/// The closed form at these times; a state that is not finite is the last.
template <HasExact P>
Reference<P> closed_form(const P& problem, const StateOf<P>& x0, const std::vector<double>& times) {
  Reference<P> result;
  result.states.reserve(times.size());
  const auto start = convert<Quad, Quad>(x0);
  for (const double t : times) {
    result.states.push_back(convert<double, double>(problem.exact(start, Quad(t))));
    if (!std::isfinite(state_error(result.states.back(), x0))) {
      result.complete = false;
      break;
    }
  }
  return result;
}

/// Two runs in quad precision to these times, the finer of them and how far the other is from it.
template <class P, class KeepGoing>
Reference<P> quad_precision_run(const P& problem, const StateOf<P>& x0, const std::vector<double>& times,
                                KeepGoing&& keep_going) {
  Reference<P> result;
  result.how = "quad precision run";
  result.states.reserve(times.size());
  const auto start = convert<Quad, Quad>(x0);
  Extrapolation<P> fine(problem, start, 1e-27), coarse(problem, start, 1e-23);
  for (const double t : times) {
    if (!fine.advance(Quad(t), keep_going) || !coarse.advance(Quad(t), keep_going)) {
      result.complete = false;
      break;
    }
    const auto truth = convert<double, double>(fine.state());
    // The difference is taken in quad, where it is not rounded away.
    StateOf<P> difference = truth;
    for (std::size_t i = 0; i < StateOf<P>::size; ++i)
      difference[i] = truth[i] + static_cast<double>(coarse.state()[i] - fine.state()[i]);
    result.uncertainty = std::max(result.uncertainty, 0x1p-53 + state_error(difference, truth));
    result.states.push_back(truth);
  }
  return result;
}

/// Whether the problem has a closed form for this start.
template <class P>
bool has_closed_form(const P& problem, const StateOf<P>& x0) {
  if constexpr (requires { problem.exact_applies(x0); }) return problem.exact_applies(x0);
  return HasExact<P>;
}

/// The true states at increasing times from x0 on. keep_going() is asked now and then by a run, never by a closed form,
/// which takes no time; false gives up.
template <class P, class KeepGoing>
Reference<P> reference_solution(const P& problem, const StateOf<P>& x0, const std::vector<double>& times,
                                KeepGoing&& keep_going) {
  if constexpr (HasExact<P>)
    if (has_closed_form(problem, x0)) return closed_form(problem, x0, times);
  return quad_precision_run(problem, x0, times, keep_going);
}

/// The same, their type forgotten.
template <class P>
Truth true_states(const P& problem, const StateOf<P>& x0, const std::vector<double>& times,
                  const KeepGoing& keep_going) {
  const auto reference = reference_solution(problem, x0, times, keep_going);
  Truth truth{{}, reference.uncertainty, reference.how, reference.complete};
  for (const auto& x : reference.states) {
    auto& state = truth.states.emplace_back();
    for (std::size_t i = 0; i < StateOf<P>::size; ++i) state.push_back(x[i]);
  }
  return truth;
}

}  // namespace least
