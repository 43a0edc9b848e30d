// One run of one problem by a scheme that sets its own clock. Samples at given times, and the final state, come from
// the dense output of the step they lie in.
#pragma once

#include "core/run/clock_engine.hpp"
#include "core/run/course_event.hpp"
#include "core/run/ledger.hpp"
#include "core/run/schedule.hpp"

namespace least {

template <class P, class X>
class ClockSession : private Ledger<P, X> {
  using Base = Ledger<P, X>;
  using Base::card_, Base::events_, Base::observer_, Base::outcome_, Base::pace_, Base::place_, Base::problem_,
      Base::request_;
  using Base::going, Base::keep_pace, Base::snap, Base::stop;

 public:
  ClockSession(const P& problem, const ProblemCard& card, const SchemeCard& scheme, const Request& request, Sink& sink,
               const std::atomic<bool>& cancelled)
      : Base(problem, card, scheme, request, sink, cancelled),
        end_(request.until_steps ? std::numeric_limits<double>::infinity() : request.end),
        times_(request, end_) {
    if constexpr (HasFrequency<P>) bound_ = stability_bound(request.scheme, request.settings, 0);
    if (bound_ > 0) met_.turn_limit = bound_ * bound_ * (1 + 1e-6);
  }

  Outcome run(ClockEngine<P, X>& engine, const X& start_state) {
    engine_ = &engine;
    place_.x = start_state;
    course_ = engine.course();
    start_ = start_state.t;
    pace_.start();
    if (start()) {
      while (going() && !arrived() && go_on()) {
      }
      if (going()) finish();
    }
    Base::close(engine.work(), place_.n);
    warn();
    return Base::outcome([&](const auto& x) { return engine.tangent(x); });
  }

 private:
  bool arrived() const { return request_.until_steps ? place_.n == request_.steps : !(place_.x.t < end_); }

  bool start() {
    along_series_ = starts_series(problem_, place_.x);
    if (!Base::start_is_sound(end_, along_series_)) return false;
    if (const std::string why = engine_->objection(); !why.empty()) return stop(Reason::singular, why);
    observer_.start(problem_, place_.x);
    snap();
    return record();
  }

  /// One block of steps and what falls due at its end.
  bool go_on() {
    const std::int64_t n = place_.n;
    if (n == request_.limits.steps) return stop(Reason::step_limit, wording::step_limit(request_.limits.steps));
    if (along_series_) {
      along_series_ = false;
      return series_step() && record() && keep_pace(1);
    }
    std::int64_t until = std::min({n + pace_.block(), request_.limits.steps, times_.step(), Base::next_snap(n)});
    if (request_.until_steps) until = std::min(until, request_.steps);
    const Status status = engine_->advance(place_, std::min(end_, times_.time()), end_, until - n, met_,
                                           observer_.wanted() ? &observer_ : nullptr);
    if (std::exchange(observer_.crossed, false)) find_events();
    note_course();
    if (place_.x.t <= end_) snap();
    return record() && (fine(status) || fail(status)) && keep_pace(place_.n - n);
  }

  /// The first step from a time at which the equations of motion are singular: along the regular solution.
  bool series_step() {
    if constexpr (HasSeries<P>) {
      const X start = place_.x, x = series_state<X>(problem_, std::min(P::series_until, end_));
      if (!(x.t > start.t)) return true;
      series_until_ = x.t;
      engine_->begin(start, x);
      place_ = {x, 1};
      observer_.see(problem_, x);
      observer_.crossed = false;
      snap();
    }
    return true;
  }
  /// The state at a time within the last step.
  Status between(X& x, double t, bool counted) {
    if constexpr (HasSeries<P>)
      if (t <= series_until_ && place_.n == 1) {
        x = t > start_ ? series_state<X>(problem_, t) : engine_->before();
        return Status::ok;
      }
    return engine_->between(x, t, counted);
  }

  bool fine(Status status) const {
    return status == Status::ok && !met_.unsound && !met_.left && !(met_.turn_squared > met_.turn_limit);
  }
  bool fail(Status status) {
    if (status == Status::underflow && course_)
      return stop(
          Reason::parameter_step_underflow,
          "the parameter's step fell below 2⁻³⁰ of its nominal length: the orbit turns ever more sharply, as in "
          "a collision or where the motion comes to rest");
    if (status == Status::solver_failed)
      return stop(Reason::solver_failed, "the equations of the step have no solution near here; a shorter step may");
    if (status != Status::ok || met_.unsound) {
      // Of steps that adapt the mean: the last ones before an end are as short as time can tell.
      const double step = place_.n > 0 ? (place_.x.t - start_) / static_cast<double>(place_.n) : 0;
      const double when = step > 0 ? Base::singularity(place_.x.t + 10 * step, step) : unknown;
      if (status == Status::singular || std::isfinite(when)) return Base::stop_as_singular(when);
    }
    if (status == Status::underflow)
      return stop(Reason::singular,
                  "a step within the tolerance is too short to advance the time: the motion is singular near here, or "
                  "the time too large");
    if (met_.left) {
      const double when = exit();
      return when > end_ ? pass_end(when) : leave(when);
    }
    if (met_.unsound)
      return stop(Reason::not_finite,
                  "the next state is not finite, or beyond 1e75 where energies overflow, or time stood still");
    const double ratio = std::sqrt(met_.turn_squared);
    return stop(Reason::unstable_step, wording::unstable(ratio, bound_, request_.settings[0] * bound_ / ratio));
  }

  /// Where the next step leads out of the domain, on a step of its own.
  double exit() const {
    if constexpr (HasDomain<P>) {
      const double step = place_.x.t - engine_->before().t;
      const auto inside = [&](double ahead) {
        X x = place_.x;
        if (ahead > 0 && engine_->leap(x, place_.x.t + ahead) != Status::ok) return -1.0;
        return problem_.inside(position(x));
      };
      double reach = step > 0 ? step : 1e-3;
      for (int k = 0; k < 60 && inside(reach) > 0; ++k) reach *= 2;
      return place_.x.t + root(inside, 0, reach);
    }
    return place_.x.t;
  }
  bool leave(double when) {
    Manner partial = manner();
    partial.step_size = when - place_.x.t;
    for (; times_.time() < when; times_.next()) {
      X x = place_.x;
      if (engine_->leap(x, times_.time()) != Status::ok || outside(x)) break;
      if (!Base::take(x, partial) || !keep_pace(1)) return false;
    }
    X x = place_.x;
    engine_->leap(x, when);
    x.t = when;
    if (observer_.sections) events_.add(0, false, x);
    return stop(Reason::left_domain, wording::left_domain(when), when);
  }
  /// The next step leads out of the domain, but the end comes first: the step is taken as far as it is good.
  bool pass_end(double when) {
    engine_->leap(place_.x, when);
    place_.x.t = when;
    ++place_.n;
    met_.left = false;
    return record();
  }

  /// Samples due within the last step or at its end.
  bool record() {
    for (; times_.time() <= place_.x.t; times_.next()) {
      X x = place_.x;
      const Status status = between(x, times_.time(), false);
      if (status != Status::ok || outside(x)) return step_back(status);
      if (!Base::take(x, manner()) || !keep_pace(1)) return false;
    }
    for (; times_.step() == place_.n && place_.x.t <= end_; times_.next()) {
      if (kept_++ < request_.limits.samples && !Base::take(place_.x, manner())) return false;
    }
    return true;
  }
  Manner manner() const {
    Manner manner;
    if (place_.n > 0) manner.step_size = place_.x.t - engine_->before().t;
    if (course_) {
      manner.mode = static_cast<double>(course_->mode);
      if (course_->parameter >= 0) manner.parameter = course_->parameter;
    }
    return manner;
  }

  /// The state at the end, which lies within the last step.
  void finish() {
    if (place_.x.t <= end_) return;
    X x = place_.x;
    const Status status = between(x, end_, true);
    if (status != Status::ok || outside(x)) {
      step_back(status);
      return;
    }
    place_.x = x;
    observer_.see(problem_, x);
    if (observer_.crossed) find_events();
  }

  /// A long step may lead out of the domain and back.
  bool outside([[maybe_unused]] const X& x) const {
    if constexpr (HasDomain<P>) return problem_.bounded() && !(problem_.inside(position(x)) >= 0);
    return false;
  }
  /// To the last state that is known to lie before the end of the motion.
  bool step_back(Status status) {
    place_ = {engine_->before(), place_.n - 1};
    return status == Status::ok ? leave(exit()) : fail(status);
  }

  void find_events() {
    const X before = engine_->before(), after = place_.x;
    events_.find(problem_, before, after, after.t - before.t, [&](double ahead) {
      X x = after;
      between(x, before.t + ahead, false);
      return x;
    });
  }

  /// A step that was taken in another way than the one before it is an event, at the state it began with.
  void note_course() {
    const auto now = engine_->course();
    if (now == course_) return;
    const auto was = std::exchange(course_, now);
    if (place_.n == 1 && now->mode == was->mode) return;  // the first step only made its choice
    if (!events_.room(outcome_.events.size())) return;
    const X& x = engine_->before();
    if constexpr (Conservative<P>) outcome_.events.push_back(course_event(card_, x.t, x.q, *was, *now));
  }

  void warn() {
    if (kept_ > request_.limits.samples)
      outcome_.warnings.push_back({"samples_truncated", "more steps than limits.samples; the first are kept"});
    if constexpr (HasFrequency<P>) Base::warn_of_step(std::sqrt(met_.turn_squared), [this](double) { return bound_; });
    if (engine_->rescues() > 0) outcome_.warnings.push_back({"steps_in_time", wording::rescues(engine_->rescues())});
    if (const std::string why = engine_->complaint(); !why.empty())
      outcome_.warnings.push_back({"off_energy_level", why});
  }

  double end_;  ///< infinite where the run is so many steps long
  Times times_;
  ClockEngine<P, X>* engine_ = nullptr;
  std::optional<Course> course_;
  ClockMet met_;
  double bound_ = std::numeric_limits<double>::infinity();
  std::int64_t kept_ = 0;
  double start_ = 0, series_until_ = -std::numeric_limits<double>::infinity();
  bool along_series_ = false;
};

}  // namespace least
