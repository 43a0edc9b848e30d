// The loop: one run of one problem under one scheme, everything known at compile time. Blocks of steps run on locals;
// what can go wrong inside one is looked for at its end, and a block that went wrong is taken back and run again step
// by step, so that the last good state is exact and a good step pays nothing.
#pragma once

#include <cmath>
#include <utility>

#include "core/catalogue.hpp"
#include "core/run/observer.hpp"
#include "core/run/pace.hpp"
#include "core/run/recorder.hpp"
#include "core/run/report.hpp"
#include "core/run/schedule.hpp"
#include "core/run/stability.hpp"
#include "core/run/structure.hpp"
#include "core/run/wording.hpp"
#include "core/scheme.hpp"
#include "core/study/reference.hpp"

namespace least {

/// A state, the stepper bound to it, and how many whole steps it has behind it. A value.
template <class P, class Stepper>
struct Machine {
  Stepper stepper;
  StateOf<P> x;
  std::int64_t n = 0;
};

/// Takes `count` whole steps. The clock is start + n·step. Returns early where a step fails, the state being the last
/// good one. `frequency` collects the largest squared local frequency that was met, where the problem estimates one.
template <bool Observed, class P, class M>
Status advance(const P& problem, M& machine, Observer<P>& observer, const Grid& grid, std::int64_t count,
               double& frequency) noexcept {
  auto stepper = machine.stepper;
  auto x = machine.x;
  double most = frequency;
  Status status = Status::ok;
  const std::int64_t end = machine.n + count;
  std::int64_t n = machine.n;
  while (n < end) {
    status = stepper.step(x, grid.step);
    if (status != Status::ok) break;
    x.t = grid.time(++n);
    if constexpr (HasFrequency<P>) {
      const double here = problem.frequency_squared(x.q);
      most = here > most ? here : most;
    }
    if constexpr (Observed) observer.see(problem, x);
  }
  machine.stepper = stepper;
  machine.x = x;
  machine.n = n;
  frequency = most;
  return status;
}

template <class P, class Scheme>
class Drive {
 public:
  using X = StateOf<P>;
  using Stepper = StepperOf<Scheme, P, X>;

  Drive(const P& problem, const Scheme& scheme, const ProblemCard& card, const Request& request, Sink& sink,
        const std::atomic<bool>& cancelled)
      : problem_(problem),
        scheme_(scheme),
        card_(card),
        request_(request),
        grid_(request, scheme.step),
        marks_(request.record, grid_),
        recorder_(problem_, request.columns, sink),
        pace_(request.limits.seconds, cancelled),
        machine_{scheme.bind(problem_, start_of(request)), start_of(request)} {
    for (const std::size_t index : request.diagnostics) {
      const std::string_view name = card.diagnostics[index];
      observer_.energy |= name == "energy";
      observer_.momenta |= name == "momenta";
      observer_.orbit |= name == "orbit";
      snapshots_wanted_ |= name == "error" || name == "structure";
    }
    if constexpr (HasFrequency<P>) bound_ = stability_bound(scheme);
  }

  Outcome run() {
    pace_.start();
    if (start()) {
      const std::int64_t whole = std::min(grid_.steps, request_.limits.steps);
      while (machine_.n < whole && go_on(whole)) {
      }
      if (going() && grid_.steps + (grid_.tail > 0) > request_.limits.steps)
        stop(Reason::step_limit, wording::step_limit(request_.limits.steps));
      if (going() && grid_.tail > 0) finish();
    }
    if (!recorder_.flush()) stop(Reason::cancelled, "the receiver of the samples went away");
    return outcome();
  }

 private:
  static X start_of(const Request& request) {
    X x;
    x.t = request.start;
    for (std::size_t i = 0; i < P::dof; ++i) {
      x.q[i] = request.initial[i];
      x.p[i] = request.initial[P::dof + i];
    }
    return x;
  }

  bool going() const { return outcome_.stop.reason == Reason::completed; }
  bool stop(Reason reason, std::string detail) {
    if (going()) outcome_.stop = {reason, std::move(detail), machine_.x.t, machine_.n, {}};
    return false;
  }

  /// Fourth powers of a good state do not overflow: its energy can be said.
  static bool sound(const X& x) {
    constexpr double most = 1e75;
    bool good = std::isfinite(x.t);
    for (std::size_t i = 0; i < P::dof; ++i) good = good && std::abs(x.q[i]) < most && std::abs(x.p[i]) < most;
    return good;
  }
  double stability_limit() const {  // of the squared frequency; a bound of 0 is no bound: the scheme always grows
    const double limit = bound_ / std::abs(grid_.step);
    return bound_ > 0 ? limit * limit * (1 + 1e-6) : std::numeric_limits<double>::infinity();
  }

  bool start() {
    const X& x = machine_.x;
    const X slope = derivative(problem_, x);
    bool finite = std::isfinite(hamiltonian(problem_, x.q, x.p, x.t));
    for (std::size_t i = 0; i < P::dof; ++i) finite = finite && std::isfinite(slope.q[i]) && std::isfinite(slope.p[i]);
    if (sound(x) && !finite) {
      stop(Reason::singular, "the equations of motion are not finite at the start");
      outcome_.stop.singular_at = x.t;
      return false;
    }
    if (!sound(x)) return stop(Reason::not_finite, "the start lies beyond 1e75, where energies overflow");
    observer_.start(problem_, x);
    snap();
    if (!record()) return false;
    if constexpr (HasFrequency<P>) {
      frequency_ = problem_.frequency_squared(x.q);
      if (frequency_ > stability_limit() && grid_.steps > 0) return unstable(frequency_);
    }
    return true;
  }

  /// Keeps a state for the diagnostics that need whole ones: at every stride-th grid point, the stride doubling
  /// whenever there are too many, so that what is kept depends on where the run got to and on no plan.
  void snap() {
    if (!snapshots_wanted_ || machine_.n % stride_ != 0) return;
    snapshots_.push_back(machine_.x);
    if (snapshots_.size() <= most_snapshots) return;
    for (std::size_t i = 0; 2 * i < snapshots_.size(); ++i) snapshots_[i] = snapshots_[2 * i];
    snapshots_.resize((snapshots_.size() + 1) / 2);
    stride_ *= 2;
  }

  bool unstable(double frequency) {
    const double omega = std::sqrt(frequency);
    return stop(Reason::unstable_step, wording::unstable(std::abs(grid_.step) * omega, bound_, bound_ / omega));
  }

  /// One block of steps and what falls due at its end.
  bool go_on(std::int64_t whole) {
    const std::int64_t before = machine_.n;
    std::int64_t until = std::min({whole, before + pace_.block(), marks_.step()});
    if (snapshots_wanted_) until = std::min(until, (before / stride_ + 1) * stride_);
    if (!block(until - before)) return false;
    if (machine_.n == grid_.steps && grid_.tail == 0) machine_.x.t = grid_.end;
    snap();
    return record() && keep_pace(machine_.n - before);
  }

  bool keep_pace(std::int64_t steps) {
    const Reason reason = pace_.passed(steps);
    if (reason == Reason::deadline) return stop(reason, wording::deadline(request_.limits.seconds));
    return reason == Reason::completed || stop(reason, "the run was cancelled");
  }

  bool block(std::int64_t count) {
    const auto saved = machine_;
    const auto seen = observer_;
    const double before = frequency_;
    Status status = steps(count);
    if (status == Status::ok && sound(machine_.x) && !(frequency_ > stability_limit())) return true;
    machine_ = saved;
    observer_ = seen;
    frequency_ = before;
    for (std::int64_t i = 0; i < count; ++i) {
      const auto last = machine_;
      const auto last_seen = observer_;
      status = steps(1);
      const bool fast = frequency_ > stability_limit();
      if (status == Status::ok && sound(machine_.x) && !fast) continue;
      const double frequency = frequency_;
      machine_.x = last.x;
      machine_.n = last.n;
      observer_ = last_seen;
      if (status != Status::ok) return failed(status);
      if (fast) return unstable(frequency);
      return overflow();
    }
    return true;  // not reached: the same steps have the same bits
  }

  bool overflow() {
    return stop(Reason::not_finite, "the next state is not finite, or beyond 1e75 where energies overflow");
  }
  bool failed(Status status) {
    if (status == Status::singular) return stop(Reason::singular, "the step is singular");
    return stop(Reason::solver_failed, "Newton's method found no solution of the implicit step; a shorter step may");
  }

  Status steps(std::int64_t count) {
    return observer_.wanted() ? advance<true>(problem_, machine_, observer_, grid_, count, frequency_)
                              : advance<false>(problem_, machine_, observer_, grid_, count, frequency_);
  }

  /// Samples due between here and the next grid point. Between grid points the step's own map fills in: a shorter step
  /// from here, on a copy, which is as accurate as the scheme, leaves the run alone and is not part of its work.
  bool record() {
    for (; marks_.step() == machine_.n; marks_.next()) {
      X x = machine_.x;
      if (marks_.rest() > 0) {
        if (machine_.n == grid_.steps && marks_.rest() == grid_.tail) return true;  // the final state
        Stepper copy = machine_.stepper;
        if (const Status status = copy.step(x, marks_.rest()); status != Status::ok) return failed(status);
        x.t = machine_.x.t + marks_.rest();
      }
      if (!take(x) || !keep_pace(1)) return false;
    }
    return true;
  }
  bool take(const X& x) {
    const auto taken = recorder_.take(x, grid_.step);
    if (taken == Recorder<P>::Taken::not_finite) return stop(Reason::not_finite, "a column is not finite here");
    return taken == Recorder<P>::Taken::yes || stop(Reason::cancelled, "the receiver of the samples went away");
  }

  /// The shorter step to the end.
  void finish() {
    const auto last = machine_;
    const Status status = machine_.stepper.step(machine_.x, grid_.tail);
    machine_.x.t = grid_.end;
    if (status != Status::ok || !sound(machine_.x)) {
      machine_.x = last.x;
      status != Status::ok ? failed(status) : overflow();
      return;
    }
    if constexpr (HasFrequency<P>) frequency_ = std::max(frequency_, problem_.frequency_squared(machine_.x.q));
    ++extra_steps_;
    observer_.see(problem_, machine_.x);
    for (; marks_.step() == machine_.n; marks_.next())
      if (!take(machine_.x)) return;
  }

  Outcome outcome() {
    outcome_.t = machine_.x.t;
    outcome_.final.assign(machine_.x.q.begin(), machine_.x.q.end());
    outcome_.final.insert(outcome_.final.end(), machine_.x.p.begin(), machine_.x.p.end());
    const Work& work = machine_.stepper.work();
    outcome_.cost = {machine_.n + extra_steps_, work.forces, work.iterations, pace_.seconds()};
    warn();
    for (const std::size_t index : request_.diagnostics)
      outcome_.diagnostics.push_back(report(card_.diagnostics[index]));
    return std::move(outcome_);
  }

  void warn() {
    if constexpr (HasFrequency<P>) {
      double careful = bound_ > 0 ? bound_ / 2 : std::numeric_limits<double>::infinity();
      if constexpr (requires { P::careful_step; }) careful = std::min(careful, P::careful_step);
      const double fastest = std::abs(grid_.step) * std::sqrt(frequency_);
      if (fastest > careful)
        outcome_.warnings.push_back({"step_near_stability_bound", wording::near_bound(fastest, careful, bound_)});
    }
  }

  Report report(std::string_view name) {
    if (name == "energy") return observer_.energy_report();
    if (name == "momenta") return observer_.momenta_report(card_);
    if (name == "orbit") return observer_.orbit_report(machine_.x);
    if (name == "structure") return structure_report(problem_, scheme_, snapshots_, machine_.x.t, grid_.step);
    return error_report(problem_, snapshots_, machine_.x, outcome_.warnings,
                        [this] { return pace_.look() == Reason::completed; });
  }

  static constexpr std::size_t most_snapshots = 256;

  P problem_;
  Scheme scheme_;
  const ProblemCard& card_;
  const Request& request_;
  Grid grid_;
  Marks marks_;
  Recorder<P> recorder_;
  Pace pace_;
  Machine<P, Stepper> machine_;
  Observer<P> observer_;
  Outcome outcome_;
  double bound_ = std::numeric_limits<double>::infinity(), frequency_ = 0;
  bool snapshots_wanted_ = false;
  std::int64_t extra_steps_ = 0, stride_ = 1;
  std::vector<X> snapshots_;  ///< states along the grid, for the diagnostics that need whole states
};

}  // namespace least
