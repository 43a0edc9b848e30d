// What every run keeps, whatever sets its clock: where it is, the samples, what the diagnostics ask for, the end.
#pragma once

#include <cmath>
#include <utility>

#include "core/run/events.hpp"
#include "core/run/pace.hpp"
#include "core/run/recorder.hpp"
#include "core/run/report.hpp"
#include "core/run/request.hpp"
#include "core/run/stability.hpp"
#include "core/run/wording.hpp"
#include "core/study/blow_up.hpp"

namespace least {

/// Fourth powers of what is smaller do not overflow: an energy can be said.
inline constexpr double largest_sound = 1e75;

template <class P, class X>
class Ledger {
 protected:
  Ledger(const P& problem, const ProblemCard& card, const SchemeCard& scheme, const Request& request, Sink& sink,
         const std::atomic<bool>& cancelled)
      : problem_(problem),
        card_(card),
        scheme_(scheme),
        request_(request),
        recorder_(problem_, card, request.columns, sink),
        pace_(request.limits.seconds, cancelled),
        events_(static_cast<std::size_t>(request.limits.samples)) {
    for (const std::size_t index : request.diagnostics) {
      const std::string_view name = card.diagnostics[index];
      observer_.energy |= name == "energy";
      observer_.momenta |= name == "momenta";
      observer_.orbit |= name == "orbit";
      observer_.decay |= name == "decay";
      observer_.entropy |= name == "entropy";
      observer_.moments |= name == "moments";
      observer_.sections |= name == "zeros" || name == "cycle" || name == "poles";
      snapshots_wanted_ |= name == "error" || name == "structure" || name == "volume";
    }
  }

  bool going() const { return outcome_.stop.reason == Reason::completed; }
  bool stop(Reason reason, std::string detail, double singular_at = unknown) {
    if (going()) outcome_.stop = {reason, std::move(detail), place_.x.t, place_.n, {}};
    if (std::isfinite(singular_at)) outcome_.stop.singular_at = singular_at;
    return false;
  }

  static bool sound(const X& x) {
    bool good = std::isfinite(x.t);
    for (std::size_t i = 0; i < X::size; ++i) good = good && std::abs(value_of(x[i])) < largest_sound;
    return good;
  }

  /// What no run to the time `end` can begin with. `excused`: the motion is regular where its equations are not.
  bool start_is_sound(double end, bool excused) {
    const X& x = place_.x;
    if constexpr (HasSeries<P>)
      if (x.t < 0 && end >= 0)
        return stop(Reason::singular, "the equations of motion are singular at t = 0, which lies ahead", 0);
    if (!sound(x)) return stop(Reason::not_finite, "the start lies beyond 1e75, where energies overflow");
    if constexpr (HasDomain<P>)
      if (problem_.bounded() && problem_.inside(x.q) < 0)
        return stop(Reason::left_domain, "the start lies outside the domain of the motion");
    const auto slope = derivative(problem_, plain(x));
    bool finite = std::isfinite(slope.t);
    for (std::size_t i = 0; i < X::size; ++i) finite = finite && std::isfinite(slope[i]);
    if constexpr (SaysEnergy<P, X>) finite = finite && std::isfinite(energy_of(problem_, x));
    if (!finite && !excused) return stop(Reason::singular, "the equations of motion are not finite at the start", x.t);
    return true;
  }

  /// Keeps a state for the diagnostics that need whole ones: at every stride-th step, the stride doubling whenever
  /// there are too many, so that what is kept depends on where the run got to and on no plan.
  void snap() {
    if (!snapshots_wanted_ || place_.n % stride_ != 0) return;
    assign(snapshots_.emplace_back(), plain(place_.x));
    if (snapshots_.size() <= most_snapshots) return;
    for (std::size_t i = 0; 2 * i < snapshots_.size(); ++i) snapshots_[i] = snapshots_[2 * i];
    snapshots_.resize((snapshots_.size() + 1) / 2);
    stride_ *= 2;
  }
  /// The step up to which nothing has to be kept.
  std::int64_t next_snap(std::int64_t n) const {
    return snapshots_wanted_ ? (n / stride_ + 1) * stride_ : std::numeric_limits<std::int64_t>::max();
  }

  bool keep_pace(std::int64_t steps) {
    const Reason reason = pace_.passed(steps);
    if (reason == Reason::deadline) return stop(reason, wording::deadline(request_.limits.seconds));
    return reason == Reason::completed || stop(reason, "the run was cancelled");
  }

  bool take(const X& x, const Manner& manner) {
    const auto taken = recorder_.take(x, manner);
    if (taken == Recorder<P, X>::Taken::not_finite)
      return stop(Reason::not_finite, wording::column(card_.columns[recorder_.wrong_column()]));
    return taken == Recorder<P, X>::Taken::yes || stop(Reason::cancelled, "the receiver of the samples went away");
  }

  /// The run is over; what follows is not part of its cost.
  void close(const Work& work, std::int64_t steps) {
    if (!recorder_.flush()) stop(Reason::cancelled, "the receiver of the samples went away");
    outcome_.cost = {steps, work.forces, work.iterations, pace_.seconds()};
  }
  /// `tangent(state)`: the derivatives of a step from there, empty where there are none.
  template <class TangentAt>
  Outcome outcome(TangentAt&& tangent) {
    outcome_.t = place_.x.t;
    for (std::size_t i = 0; i < card_.variables.size(); ++i) {
      const bool shown =
          !card_.variables[i].optional || std::ranges::find(request_.columns, i + 1) != request_.columns.end();
      outcome_.final.push_back(shown ? variable(place_.x, i) : unknown);
    }
    if (events_.full())
      outcome_.warnings.push_back({"events_truncated", "more events than limits.samples; the first are listed"});
    for (const std::size_t index : request_.diagnostics)
      outcome_.diagnostics.push_back(report(card_.diagnostics[index], tangent));
    return std::move(outcome_);
  }

  /// When the motion that began at the start becomes infinite, if it does so before `latest`: the reference integrator
  /// knows. `step`: a length of time in which little happens.
  double singularity([[maybe_unused]] double latest, [[maybe_unused]] double step) {
    if constexpr (QuadraticContact<P>) {
      return true_blow_up_time(problem_, start_of<X>(problem_, request_.initial, request_.start), latest, step,
                               [this] { return pace_.look() == Reason::completed; });
    }
    return unknown;
  }
  bool stop_as_singular(double when) {
    return stop(Reason::singular,
                std::isfinite(when) ? wording::blow_up(when) : "the step is singular here; a shorter one may not be",
                when);
  }

  /// Of the largest ωh met. `bound(needed)`: the scheme's, infinite where it lies beyond `needed`.
  template <class Bound>
  void warn_of_step(double fastest, Bound&& bound) {
    double most = bound(2 * fastest), careful = most > 0 ? most / 2 : std::numeric_limits<double>::infinity();
    if constexpr (requires { P::careful_step; }) careful = std::min(careful, P::careful_step);
    if (!(fastest > careful)) return;
    most = bound(std::numeric_limits<double>::infinity());
    outcome_.warnings.push_back({"step_near_stability_bound", wording::near_bound(fastest, careful, most)});
  }

  P problem_;
  const ProblemCard& card_;
  const SchemeCard& scheme_;
  const Request& request_;
  Recorder<P, X> recorder_;
  Pace pace_;
  Place<X> place_;
  Observer<P, X> observer_;
  Events<P, X> events_;
  Outcome outcome_;
  bool snapshots_wanted_ = false;
  std::int64_t stride_ = 1;

 private:
  template <class TangentAt>
  Report report(std::string_view name, TangentAt&& tangent) {
    const auto here = plain(place_.x);
    FullStateOf<P> final;
    assign(final, here);
    if (name == "energy") return observer_.energy_report();
    if (name == "momenta") return observer_.momenta_report(card_);
    if (name == "orbit") return observer_.orbit_report(place_.x);
    if (name == "decay") return observer_.decay_report();
    if (name == "entropy") return observer_.entropy_report();
    if (name == "moments") return observer_.moments_report();
    if (name == "zeros") return events_.zeros();
    if (name == "cycle") return events_.cycle();
    if (name == "poles") return events_.poles();
    if (name == "structure") return structure_report<P>(tangent, scheme_.structure, snapshots_, here.t);
    if (name == "volume") return volume_report(tangent, problem_, snapshots_, here.t);
    return error_report(problem_, snapshots_, final, outcome_.warnings,
                        [this] { return pace_.look() == Reason::completed; });
  }

  static constexpr std::size_t most_snapshots = 256;
  std::vector<FullStateOf<P>> snapshots_;  ///< states along the run, for the diagnostics that need whole states
};

}  // namespace least
