// Where a motion ends: at a place where its rates are infinite or not defined, which steps with error control approach
// and never reach. What short steps alone say is not enough: a stiff motion has them, too, as has a fast one, or a time
// so large that rounding moves it. So Dormand–Prince 5(4) at other tolerances than the run's is asked.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "core/problem_traits.hpp"
#include "core/run/request.hpp"
#include "core/schemes/odeint.hpp"

namespace least {

/// Watches for steps that no longer advance a run: one too short to bring it to its end within a million steps, and not
/// on the way to a singularity either, where each step is shorter than all before it.
class StandstillWatch {
 public:
  /// `span`: of the whole run, 0 where it is not known beforehand.
  StandstillWatch(double start, double span) : start_(start), span_(span) {}

  /// Of a step h from the time t. True: it is time to ask whether the motion goes on at all.
  bool see(double t, double h) {
    constexpr double little = 1e-6;
    if (!(h < little * std::max(t - start_, span_))) {
      count_ = 0;
      shortest_ = std::numeric_limits<double>::infinity();
      return false;
    }
    count_ += h >= shortest_;
    shortest_ = std::min(shortest_, h);
    return count_ >= patience_;
  }
  /// It does go on: the question is worth its price again after twice as many such steps.
  void go_on() {
    count_ = 0;
    patience_ *= 2;
  }

 private:
  double start_, span_;
  std::int64_t count_ = 0, patience_ = 1000;
  double shortest_ = std::numeric_limits<double>::infinity();
};

/// The largest of the rates of a state; NaN where one is no number.
template <class P>
double largest_rate(const P& problem, const StateOf<P>& x) {
  const auto rate = derivative(problem, x);
  double most = 0;
  for (std::size_t i = 0; i < StateOf<P>::size; ++i)
    if (const double size = std::abs(rate[i]); !(size <= most)) most = size;
  return most;
}

/// Whether the motion from x goes on for so long. A closer run that takes the time of a few dozen steps of the run in a
/// bounded number of its own has gone through. One that does not is before a singularity if it ends, or if its rates
/// grow and its steps shrink the closer it looks. Where they do not, as with friction that turns over with the velocity
/// or a fast oscillation, it is only slow.
template <class P>
bool goes_on(const P& problem, StateOf<P> x, double duration) {
  constexpr int patience = 10'000;
  constexpr double closely = 1e-14, growth = 3, shrinkage = 1e-2;
  auto stepper = AnyOdeintScheme{odeint::Method::dormand_prince_5, closely}.bind(problem, x);
  const double end = x.t + duration, before = largest_rate(problem, x);
  double most = before, longest = 0;
  for (int step = 0; x.t < end; ++step) {
    const double t = x.t;
    if (stepper.step(x) != StepStatus::ok) return false;
    most = std::max(most, largest_rate(problem, x));
    longest = std::max(longest, x.t - t);
    if (step == patience) return !(most > growth * before && x.t - t < shrinkage * longest);
  }
  return true;
}

/// A control run on its way to a place where the motion ends.
template <class P>
class Approach {
 public:
  /// Of a walk: the time it came to, and whether it can go no further.
  struct End {
    double t;
    bool stands;
  };

  /// `most_forces`: evaluations of each of the walks; keep_going() is asked now and then.
  Approach(const P& problem, const StateOf<P>& start, std::int64_t most_forces, const KeepGoing& keep_going)
      : problem_(problem), start_(start), most_forces_(most_forces), keep_going_(keep_going) {
    for (std::size_t i = 0; i < StateOf<P>::size; ++i) size_ = std::max(size_, std::abs(start[i]));
    if (!(size_ > 0 && size_ < 1)) size_ = 1;
  }

  /// From the start to `until`, or as far as steps lead; see(state) is called after each.
  template <class See>
  End walk(double tolerance, double until, See&& see) const {
    auto x = start_;
    auto stepper =
        AnyOdeintScheme{odeint::Method::dormand_prince_5, std::max(tolerance * size_, 1e-300)}.bind(problem_, x);
    StandstillWatch watch(start_.t, 0);
    for (int step = 1; x.t < until; ++step) {
      const double before = x.t;
      if (stepper.work().forces > most_forces_ || (step % 256 == 0 && !keep_going_())) break;
      if (stepper.step(x) != StepStatus::ok || watch.see(before, x.t - before)) return {x.t, true};
      if constexpr (HasDomain<P>)
        if (problem_.bounded() && !(problem_.inside(x.q) >= 0)) break;
      see(x);
    }
    return {x.t, false};
  }

  /// Whether rates change on each scale of time on the way to `end`, as powers of what is left of it do: a walk has to
  /// stop on each, and of a rate that is smooth at the end less and less of a change is left. Not so where the steps
  /// are short for another reason.
  bool sharpens(double tolerance, double end) const {
    constexpr int scales = 5;
    constexpr double first = 1e-2, least_change = 0.02, noise = 1e-12;
    const double span = end - start_.t;
    using Rates = decltype(derivative(problem_, start_));
    std::array<std::optional<Rates>, scales> at;  // after the first step that ends within first·10⁻ᵏ of the end
    walk(tolerance, end, [&](const StateOf<P>& x) {
      const double left = (end - x.t) / span;
      if (!(left > 0 && left < first)) return;
      const int scale = static_cast<int>(std::floor(std::log10(first / left)));
      if (scale < scales && !at[static_cast<std::size_t>(scale)])
        at[static_cast<std::size_t>(scale)] = derivative(problem_, x);
    });
    int changes = 0;
    std::optional<Rates> last;
    for (const auto& rates : at) {
      if (!rates) continue;  // one may be leapt over, where a step is short for its end alone
      if (last) {
        double most = 0, largest = 0;
        for (std::size_t i = 0; i < StateOf<P>::size; ++i)
          largest = std::max({largest, std::abs((*last)[i]), std::abs((*rates)[i])});
        for (std::size_t i = 0; i < StateOf<P>::size; ++i)
          if (const double size = std::max(std::abs((*last)[i]), std::abs((*rates)[i])); size > noise * largest)
            most = std::max(most, std::abs((*rates)[i] - (*last)[i]) / size);
        if (!(most > least_change)) return false;
        ++changes;
      }
      last = rates;
    }
    return changes >= 3;
  }

 private:
  const P& problem_;
  StateOf<P> start_;
  std::int64_t most_forces_;
  const KeepGoing& keep_going_;
  double size_ = 0;
};

/// When the motion of a request becomes singular, where a run of it stopped at `now` after so many force evaluations:
/// as two control runs say that come to a standstill together; of steps of a clock of their own the run may be one of
/// the two. `step`: of a run of equal steps, else 0. Unknown where it is not known to 1e-4 of the time until then, or
/// does not lie within a few steps, or a tenth of the way, of where the run stopped: then it stopped for another
/// reason. Not asked where it was an equation of the step that had no solution.
template <class P>
double singular_time(const P& problem, const Request& request, StepStatus status, double now, double step,
                     std::int64_t forces, const KeepGoing& keep_going) {
  constexpr double close = 1e-12, near = 1e-5, few_steps = 10, stretch = 0.1;
  constexpr std::int64_t few = 20'000, many = 200'000;
  if (request.probe || status == StepStatus::solver_failed) return unknown;
  const Scene& scene = *request.scene;
  auto start = start_of<StateOf<P>>(problem, scene.initial, scene.start);
  const double way = stretch * (now - start.t), earliest = now - std::max(way, few_steps * step),
               latest = now + (step > 0 ? few_steps * step : way);
  if constexpr (HasSeries<P>)
    if (starts_series(problem, start)) start = series_state<StateOf<P>>(problem, P::series_until);
  if (!(start.t < latest)) return unknown;
  const Approach<P> approach(problem, start, std::clamp<std::int64_t>(10 * forces, few, many), keep_going);
  const auto unseen = [](const StateOf<P>&) {};
  const auto one = approach.walk(100 * close, latest, unseen), other = approach.walk(close, latest, unseen);
  const auto agree = [&](double a, double b) { return std::abs(a - b) < near * (b - start.t); };
  double known = unknown;
  if (other.stands && (one.stands ? agree(one.t, other.t) : step == 0 && agree(now, other.t)))
    known = other.t;
  else if (!other.stands && one.stands && step == 0 && agree(one.t, now))
    known = now;
  if (!(known >= earliest && known <= latest)) return unknown;
  return approach.sharpens(close, known) ? known : unknown;
}

}  // namespace least
