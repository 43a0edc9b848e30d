// One run of one problem by fixed steps: the grid, the samples, the diagnostics and the end, around blocks of steps
// that an engine takes. What can go wrong inside a block is looked for at its end, and a block that went wrong is taken
// back and run again step by step, so that the last good state is exact and a good step pays nothing.
#pragma once

#include "core/run/engine.hpp"
#include "core/run/ledger.hpp"
#include "core/run/regular.hpp"
#include "core/run/root.hpp"
#include "core/run/schedule.hpp"

namespace least {

template <class P, class X>
class Session : private Ledger<P, X> {
  using Base = Ledger<P, X>;
  using Base::card_, Base::events_, Base::observer_, Base::outcome_, Base::pace_, Base::place_, Base::problem_,
      Base::request_;
  using Base::going, Base::keep_pace, Base::snap, Base::sound, Base::stop;

 public:
  Session(const P& problem, const ProblemCard& card, const SchemeCard& scheme, const Request& request, double step,
          Sink& sink, const std::atomic<bool>& cancelled)
      : Base(problem, card, scheme, request, sink, cancelled), grid_(request, step), marks_(request.record, grid_) {
    if constexpr (HasFrequency<P>) {
      if constexpr (ConstantDamping<P>) damping_step_ = std::max(problem.damping() * step, 0.0);
      // A scheme that grows at every step without damping is not unstable with it, it is what it is.
      if (stability_bound(request.scheme, request.settings, 0, 0) > 0) cleared_ = 0;
    }
  }

  Outcome run(Engine<P, X>& engine, const X& start_state) {
    engine_ = &engine;
    place_.x = start_state;
    pace_.start();
    if (start()) {
      const std::int64_t whole = std::min(grid_.steps, request_.limits.steps);
      while (place_.n < whole && go_on(whole)) {
      }
      if (going() && grid_.steps + (grid_.tail > 0) > request_.limits.steps)
        stop(Reason::step_limit, wording::step_limit(request_.limits.steps));
      if (going() && grid_.tail > 0) finish();
    }
    Base::close(engine.work(), place_.n + extra_steps_);
    warn();
    return Base::outcome([&](const auto& x) { return engine.tangent(x, grid_.step); });
  }

 private:
  double bound(double needed) const {
    return stability_bound(request_.scheme, request_.settings, damping_step_, needed);
  }
  /// Whether steps are too long for this squared frequency. The bound is measured as far as it is asked for.
  bool too_fast(double frequency) {
    if (!(frequency > cleared_)) return false;
    const double h = std::abs(grid_.step), needed = 4 * h * std::sqrt(frequency);
    const double limit = std::min(bound(needed), needed) / h;
    cleared_ = limit * limit * (1 + 1e-6);
    return frequency > cleared_;
  }

  bool start() {
    const X& x = place_.x;
    regular_.start(problem_, *engine_, x, grid_);
    if (!Base::start_is_sound(grid_.end,
                              regular_.active() || (regular_.at_rest(x) && engine_->starts_at_singularity())))
      return false;
    if (const std::string why = engine_->objection(); !why.empty()) return stop(Reason::singular, why);
    observer_.start(problem_, x);
    snap();
    if (!record()) return false;
    if constexpr (QuadraticContact<P>)
      if (-problem_.action_curvature() * x.action.s * grid_.step > 2 && grid_.steps > 0)
        return failed(Status::singular);
    if constexpr (HasFrequency<P>) {
      met_.frequency = problem_.frequency_squared(position(x));
      if (grid_.steps > 0 && too_fast(met_.frequency)) return unstable(met_.frequency);
    }
    return true;
  }

  bool unstable(double frequency) {
    const double omega = std::sqrt(frequency);
    const double most = bound(std::numeric_limits<double>::infinity());
    double longest = most / omega;
    if constexpr (ConstantDamping<P>)
      longest = longest_stable_step(request_.scheme, request_.settings, omega, problem_.damping(), grid_.step);
    return stop(Reason::unstable_step, wording::unstable(std::abs(grid_.step) * omega, most, longest));
  }

  /// One block of steps and what falls due at its end.
  bool go_on(std::int64_t whole) {
    const std::int64_t before = place_.n;
    std::int64_t until = std::min({whole, before + pace_.block(), marks_.step(), Base::next_snap(before)});
    if (observer_.sections) until = std::min(until, before + 256);  // a crossing runs them twice
    if (regular_.takes(before)) {
      if (!regular_step()) return false;
    } else if (!block(until - before)) {
      return false;
    }
    if (place_.n == grid_.steps && grid_.tail == 0) place_.x.t = grid_.end;
    snap();
    return record() && keep_pace(place_.n - before);
  }

  bool good(Status status) {
    return status == Status::ok && sound(place_.x) && !too_fast(met_.frequency) && !met_.left && !(met_.pull > 2);
  }

  bool block(std::int64_t count) {
    const auto saved = place_;
    const auto seen = observer_;
    const Met met = met_;
    engine_->save();
    Status status = advance(count);
    if (good(status) && !observer_.crossed) return true;
    engine_->restore();
    place_ = saved;
    observer_ = seen;
    met_ = met;
    for (std::int64_t i = 0; i < count; ++i) {
      const auto last = place_;
      const auto last_seen = observer_;
      engine_->save();
      status = advance(1);
      if (good(status)) {
        if (observer_.crossed) find_events(last.x, grid_.step);
        observer_.crossed = false;
        continue;
      }
      const X bad = place_.x;
      place_ = last;
      observer_ = last_seen;
      return fail(status, bad);
    }
    return true;
  }

  /// A step from here ended in `bad`.
  bool fail(Status status, const X& bad) {
    const bool left = std::exchange(met_.left, false);
    const double pull = std::exchange(met_.pull, 0);
    if (status != Status::ok) return failed(status);
    if (pull > 2) return failed(Status::singular);
    if constexpr (HasDomain<P>) {
      if (left && sound(bad)) {
        const auto inside = [&](double ahead) {
          X x = place_.x;
          if (ahead > 0) engine_->peek(x, ahead, true);
          return problem_.inside(x.q);
        };
        const double ahead = root(inside, 0, grid_.step);
        X x = place_.x;
        x.t += ahead;
        if (observer_.sections) events_.add(0, false, x);
        return stop(Reason::left_domain, wording::left_domain(x.t), x.t);
      }
    }
    if (!sound(bad))
      return stop(Reason::not_finite, "the next state is not finite, or beyond 1e75 where energies overflow");
    return unstable(met_.frequency);
  }
  bool failed(Status status) {
    const double when = Base::singularity(place_.x.t + 10 * grid_.step, grid_.step);
    if (status == Status::singular) return Base::stop_as_singular(when);
    return stop(Reason::solver_failed, "Newton's method found no solution of the implicit step; a shorter step may",
                when);
  }

  Status advance(std::int64_t count) {
    return engine_->advance(place_, grid_, count, met_, observer_.wanted() ? &observer_ : nullptr);
  }

  /// One step along the regular solution from a singular time.
  bool regular_step() {
    X x = place_.x;
    if (const Status status = regular_.go(problem_, *engine_, x, grid_.time(place_.n + 1)); status != Status::ok)
      return failed(status);
    if (!sound(x)) return stop(Reason::not_finite, "the next state is not finite");
    place_ = {x, place_.n + 1};
    if (regular_.ends(place_.n)) engine_->rebind(x);
    observer_.see(problem_, x);
    observer_.crossed = false;
    return true;
  }
  /// The state `ahead` after the place, on a copy.
  Status look_ahead(X& x, double ahead) {
    x = place_.x;
    const double t = place_.x.t + ahead;
    const Status status =
        regular_.covers(place_.n, t) ? regular_.go(problem_, *engine_, x, t) : engine_->peek(x, ahead);
    x.t = t;
    return status;
  }

  /// Samples due between here and the next grid point. Between grid points the step's own map fills in: a shorter step
  /// from here, on a copy, which is as accurate as the scheme, leaves the run alone and is not part of its work.
  bool record() {
    for (; marks_.step() == place_.n; marks_.next()) {
      X x = place_.x;
      if (marks_.rest() > 0) {
        if (place_.n == grid_.steps && marks_.rest() == grid_.tail) return true;  // the final state
        if (const Status status = look_ahead(x, marks_.rest()); status != Status::ok) return failed(status);
      }
      if (!take(x) || !keep_pace(1)) return false;
    }
    return true;
  }
  bool take(const X& x) { return Base::take(x, {grid_.step}); }

  /// What crossed zero within the step from `before`, which the engine has saved.
  void find_events(const X& before, double h) {
    const auto at = [&](double ahead) {
      X x = before;
      if (ahead > 0) engine_->peek(x, ahead, true);
      x.t = before.t + ahead;
      return x;
    };
    events_.find(problem_, before, place_.x, h, at);
  }

  /// The shorter step to the end.
  void finish() {
    const auto last = place_;
    engine_->save();
    const bool regular = regular_.covers(place_.n, grid_.end);
    const Status status =
        regular ? regular_.go(problem_, *engine_, place_.x, grid_.end) : engine_->step(place_.x, grid_.tail);
    place_.x.t = grid_.end;
    if constexpr (Sloped<X>) normalise(place_.x);
    if constexpr (HasDomain<P>) met_.left = problem_.bounded() && !(problem_.inside(place_.x.q) >= 0);
    if (status != Status::ok || !sound(place_.x) || met_.left) {
      const X bad = place_.x;
      place_ = last;
      fail(status, bad);
      return;
    }
    if constexpr (HasFrequency<P>)
      met_.frequency = std::max(met_.frequency, problem_.frequency_squared(position(place_.x)));
    ++extra_steps_;
    observer_.see(problem_, place_.x);
    if (observer_.crossed && !regular) find_events(last.x, grid_.tail);
    for (; marks_.step() == place_.n; marks_.next())
      if (!take(place_.x)) return;
  }

  void warn() {
    const double h = std::abs(grid_.step);
    if constexpr (HasFrequency<P>)
      Base::warn_of_step(h * std::sqrt(met_.frequency), [this](double needed) { return bound(needed); });
    if constexpr (requires { problem_.stiffness_rate(); }) {
      if (problem_.stiffness_rate() * h > 0.5)
        outcome_.warnings.push_back({"stiff_step", wording::stiff(problem_.stiffness_rate() * h)});
    }
    if (const auto t = engine_->flips_momentum(grid_, place_.n))
      outcome_.warnings.push_back({"damping_sign", wording::damping_sign(*t)});
  }

  Grid grid_;
  Marks marks_;
  Engine<P, X>* engine_ = nullptr;
  RegularStart<P, X> regular_;
  Met met_;
  double damping_step_ = 0;
  double cleared_ = std::numeric_limits<double>::infinity();  ///< squared frequency up to which steps are stable
  std::int64_t extra_steps_ = 0;
};

}  // namespace least
