// A run while it lasts: its data, what it does at each block of steps (run.cpp) and how it ends (run_ends.cpp).
#pragma once

#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "core/number/asked_by_thread.hpp"
#include "core/run/acts.hpp"
#include "core/run/budget.hpp"
#include "core/run/crossings.hpp"
#include "core/run/damping_pole.hpp"
#include "core/run/evidence.hpp"
#include "core/run/integrator.hpp"
#include "core/run/messages.hpp"
#include "core/run/run.hpp"
#include "core/run/save_schedule.hpp"
#include "core/run/section_times.hpp"
#include "core/run/snapshots.hpp"
#include "core/run/trajectory_writer.hpp"
#include "core/run/warnings.hpp"

namespace least {

/// SectionSink passes the rows of a section to the sink of a run.
class SectionSink final : public RowSink {
 public:
  explicit SectionSink(RowSink& sink) : sink_(sink) {}
  bool append(std::span<const double> rows) override { return sink_.append_section(rows); }

 private:
  RowSink& sink_;
};

class Run {
 public:
  Run(const RunBackend& backend, const Request& request, const std::vector<Column>& columns, RowSink& sink,
      const std::atomic<bool>& cancelled)
      : backend_(backend),
        request_(request),
        grid_(request, fixed_ ? nominal_step() : 0),
        loop_end_(fixed_ || request.until_steps ? infinite : request.end),
        end_(fixed_ ? grid_.end : loop_end_),
        last_step_(fixed_                ? grid_.steps
                   : request.until_steps ? request.steps
                                         : SaveSchedule::never),
        schedule_(request, end_),
        drawn_(request.record.mode == Record::Mode::curve ? scene_.start : infinite),
        section_times_(request.section, scene_.start),
        sink_(sink),
        section_sink_(sink),
        writer_(problem_, request, keeps_samples() ? request.columns : std::vector<std::size_t>(), columns,
                request.record.mode == Record::Mode::curve ? request.record.count : 0, sink),
        section_writer_(problem_, request, request.section ? request.section_columns() : std::vector<std::size_t>(),
                        columns, 0, section_sink_),
        budget_(request.limits.seconds, cancelled, [this] { return report(); }),
        watch_(request),
        diagnostics_(backend, request, watch_, budget_.shortly()),
        events_(static_cast<std::size_t>(most_rows_)),
        guard_(request.scheme, request.settings, guarded_damping(problem_) * grid_.step, problem_.traits.has_frequency,
               problem_.traits.constant_frequency, request.probe),
        evidence_(problem_.traits, fixed_ ? std::optional(grid_.steps) : std::nullopt, request.control) {}

  Solution solve() {
    const AskedByThread asked(budget_.in_time());
    state_.x = problem_.start(scene_.initial, scene_.start);
    damping_pole_ = damping_pole(problem_, state_.x.t, end_);
    integrator_ = backend_.bind(request_, state_.x, grid_, std::min(end_, own_clock_end()));
    method_ = integrator_->method();
    shows_discrete_energy_ = std::ranges::any_of(
        request_.columns, [&](std::size_t i) { return request_.column(i).name == "discrete_energy"; });
    keep_last_step();
    budget_.start(weight_of_force(*scene_.mechanics));
    if (initialize()) {
      do {
        while (going() && !arrived() && advance_block()) continue;
        if (going()) finish();
      } while (start_anew());
    }
    return conclude();
  }

 private:
  static constexpr double infinite = std::numeric_limits<double>::infinity();

  bool keeps_samples() const { return request_.record.mode != Record::Mode::every || request_.record.count > 0; }
  /// report tells the sink how far the run got, and hands over the rows that wait. False: the sink takes no more.
  bool report() {
    return writer_.hand_over() && section_writer_.hand_over() && sink_.progress(std::min(state_.x.t, end_), state_.n);
  }
  /// start_anew goes on after an event that acts has ended the run: it applies the act, then the other acts of the same
  /// instant, each to the state that the one before has left. False: the run is over.
  bool start_anew();
  /// act applies the act of one event. False: the run cannot go on from there.
  bool act(std::size_t which);
  Work work() const {
    const Work here = integrator_->work();
    return {put_aside_.forces + here.forces, put_aside_.iterations + here.iterations};
  }

  bool going() const { return outcome_.stop.reason == ReturnCode::completed; }
  bool arrived() const { return ended_ || state_.n == last_step_ || !(state_.x.t < loop_end_); }
  bool stop(ReturnCode reason, Message detail, double singular_at = unknown) {
    if (!fixed_ && state_.x.t > end_) step_back();
    if (going()) outcome_.stop = {reason, std::move(detail), state_.x.t, state_.n, {}};
    if (std::isfinite(singular_at)) outcome_.stop.singular_at = singular_at;
    return false;
  }
  void warn(std::string_view code, Message detail) { outcome_.warnings.push_back({code, std::move(detail)}); }
  bool keep_going() { return budget_.look() == ReturnCode::completed; }
  bool within_budget(std::int64_t steps) { return goes_on(budget_.passed(steps)); }
  bool goes_on(ReturnCode reason) {
    if (reason == ReturnCode::deadline) return stop(reason, messages::deadline(request_.limits.seconds));
    return reason == ReturnCode::completed || stop(reason, "the run was cancelled");
  }
  bool within_step_limit() {
    return state_.n != request_.limits.steps ||
           stop(ReturnCode::step_limit, messages::step_limit(request_.limits.steps));
  }

  bool initialize();

  /// advance_block takes one block of steps and does what falls due at its end.
  bool advance_block();

  /// Locates the zeros of sections within the last step.
  void locate_sections() {
    if (diagnostics_.watches_sections()) least::locate_sections(problem_, *integrator_, state_, events_);
  }
  /// locate_watched records the events between two states of the last or of the next step, up to the first that ends
  /// the run. Events in the same instant as one that acts are handled after its act; an act in the same instant as an
  /// earlier event that stops the run does not happen.
  void locate_watched(const RunState& from, const RunState& to) {
    bool acts = false;
    const auto keep_going = [this] {
      if (cut_short_ == ReturnCode::completed) cut_short_ = budget_.look();
      return cut_short_ == ReturnCode::completed;
    };
    for (const auto& [zero, x] : watched_zeros(problem_, *integrator_, state_, watch_, from, to, keep_going)) {
      if (acts) {
        ended_->also.push_back(zero.which);
        continue;
      }
      add_event(zero, x);
      if (!watch_.ends(zero.which) || ended_) continue;  // the run is over with the first that stops it
      ended_.emplace(EndAtEvent{x, zero.which, {}});
      end_ = x.t;
      acts = request_.events[zero.which].act != nullptr;
    }
  }
  /// searched returns whether the last step was searched to its end. Otherwise the step is undone, since it is not
  /// known what happened in it, and the run ends.
  bool searched() {
    if (cut_short_ == ReturnCode::completed) return true;
    if (!fixed_) step_back();
    return goes_on(cut_short_);
  }
  void add_event(const Zero& zero, const RunState& x) {
    if (request_.is_plane(zero.which)) return pass(x);
    // The memory of one event, in numbers.
    const std::size_t size = 32 * std::max<std::size_t>(card_.variables.size() / 16, 1);
    if (events_.room(size * outcome_.events.size()))
      outcome_.add_event(watch_.event(zero, card_, shown_variables(request_, problem_.traits, x)));
  }
  /// step_back undoes the last step, and drops what was found in it.
  void step_back() {
    integrator_->step_back(state_);
    std::erase_if(outcome_.events, [&](const Report& event) { return Watch::time(event) > state_.x.t; });
    std::erase_if(passed_, [&](const Passage& point) { return point.x.t > state_.x.t; });
    if (!ended_ || !(ended_->x.t > state_.x.t)) return;
    ended_.reset();
    end_ = planned_end_;
  }
  /// record_method_switch reports a step by another method than the one before as an event, at the state where the step
  /// began.
  void record_method_switch();

  /// keep_last_step lets the integrator keep what is looked for within the last step: rows by time, a curve, events.
  void keep_last_step() {
    if (shows_discrete_energy_ || drawn_ < infinite || !watch_.empty() || due() < infinite)
      integrator_->keep_last_step();
  }
  /// The time of the next row, of the samples or of a section by time.
  double due() const { return std::min(schedule_.time(), section_times_.time()); }
  /// Saves that row, or both where they have the same time.
  bool save_next(const RunState& x, const StepInfo& step) {
    const double t = due();
    const bool sample = schedule_.time() == t, point = section_times_.time() == t;
    if (sample) schedule_.next();
    if (point) section_times_.next();
    return (!sample || save(x, step)) && (!point || save_point(x, step)) && within_budget(1);
  }
  /// Saves all rows by time up to the state. A step is taken before the rows in it are saved, because it may go wrong,
  /// or an event in it may end the run. Rows in steps of equal length say how the step before theirs was taken, which
  /// is `before` for those in the last step.
  bool save_due(const StepInfo& before);
  /// The number of the whole step up to which a run goes for a row at the time `due`: the last one before the row, then
  /// the one in which the row lies.
  std::int64_t step_towards(double due) const;
  /// The first time of rows within the step ahead, to the end, at which that step is outside the domain, to which it
  /// may return; unknown if there is none.
  double time_outside() const;
  /// The state at a time within the last step, by a Hermite polynomial between its ends.
  StepStatus between_ends_of_step(double t, RunState& x) const;
  /// How the last step, which ended in the state, was taken.
  StepInfo last_step() const {
    StepInfo step = integrator_->step_info(state_);
    if (shows_discrete_energy_) step.discrete_energy = integrator_->discrete_energy(state_);
    return step;
  }
  bool save(const RunState& x, const StepInfo& step) { return save(x, step, writer_); }
  bool save(const RunState& x, const StepInfo& step, TrajectoryWriter& writer) {
    const auto written = writer.write_row(x, step);
    if (written == TrajectoryWriter::Written::not_finite)
      return stop(ReturnCode::not_finite, messages::column(writer.wrong_column()));
    return written == TrajectoryWriter::Written::yes || receiver_is_gone();
  }
  /// Saves a point of the section, as long as there is room.
  bool save_point(const RunState& x, const StepInfo& step) {
    return points_++ >= most_points_ || save(x, step, section_writer_);
  }
  /// pass notes that the run passes the plane of the section at x, unless that is where an act has just restarted the
  /// run: then it was noted before the act.
  void pass(const RunState& x) {
    constexpr double rounding = 4 * std::numeric_limits<double>::epsilon();
    if (!acted_ || x.t > began_ + rounding * std::abs(began_)) passed_.push_back({x, last_step()});
  }
  /// Saves the passages of the plane, once their step can no longer be undone.
  bool save_passed() {
    for (const auto& [x, step] : std::exchange(passed_, {}))
      if (!save_point(x, step)) return false;
    return true;
  }
  /// draw saves samples from the last one up to the time t, within the last step or one ahead, for a curve.
  bool draw(double t);
  bool receiver_is_gone() { return stop(ReturnCode::cancelled, "the receiver of the samples went away"); }

  /// finish moves the state to the end, by a shorter step or within the last one, and saves the samples up to there.
  void finish();
  /// Saves the samples that are left up to the state x, in which the run ends.
  bool save_rest(const RunState& x, const StepInfo& step);

  /// finish_at_event ends the run at an event within the last step, or in the part of the next one that stays in the
  /// domain. Samples by time go up to the event, samples by steps up to the last step before it; for diagnostics the
  /// last step ends at the event.
  void finish_at_event();

  /// fail ends the run for what went wrong in the step ahead of the state.
  bool fail(const BlockResult& result);

  /// The time at which the true motion from the start becomes infinite, if that is near the present time; else unknown.
  double true_singularity();
  bool stop_as_unstable();
  /// own_clock_end returns the time that a scheme with its own clock does not pass because the damping is infinite soon
  /// after: one where a millionth of the way to that pole is left, since steps may become ever shorter towards it.
  /// Infinite without a pole, and for equal steps, which look for it themselves.
  double own_clock_end() const {
    constexpr double left = 1e-6;
    return fixed_ || damping_pole_ == infinite ? infinite : damping_pole_ - left * (damping_pole_ - scene_.start);
  }
  /// stop_at_pole ends the run of a scheme with its own clock before the pole of the damping.
  bool stop_at_pole();
  /// Returns the pole of the damping if it lies so close ahead that it is why a step failed, else `unknown`.
  double pole_ahead() const;
  double nominal_step() const { return request_.setting("step", scheme_); }
  /// leave_domain handles a next step that ends outside the domain, or is outside at `outside_at`: the run goes on to
  /// the boundary, or to its end if that comes first.
  bool leave_domain(double outside_at = unknown);
  Solution conclude();

  void warn_of_the_run();

  const RunBackend& backend_;
  const Request& request_;
  const ProblemTable& problem_ = backend_.table();
  const Scene& scene_ = *request_.scene;
  const ProblemCard& card_ = scene_.card();
  const SchemeCard& scheme_ = scene_.mechanics->schemes()[request_.scheme];
  bool fixed_ = !scheme_.own_clock;  ///< steps of equal length, those of grid_; else grid_.step is 0
  Grid grid_;
  double loop_end_;  ///< steps go on until one reaches this time; infinite if the run ends by the number of steps
  double end_;       ///< the time of the final state; infinite where it is not known beforehand
  double planned_end_ = end_;
  double damping_pole_ = infinite;  ///< the first time ahead at which the damping is infinite
  std::int64_t last_step_;          ///< steps go on until there are this many
  SaveSchedule schedule_;
  double drawn_;  ///< time up to which samples draw the curve; infinite where they do not
  SectionTimes section_times_;
  RowSink& sink_;
  SectionSink section_sink_;
  TrajectoryWriter writer_, section_writer_;
  const std::int64_t most_rows_ = request_.most_rows();
  const std::int64_t most_points_ = request_.most_points();
  Budget budget_;
  Watch watch_;
  Acts acts_{backend_, request_};
  bool acted_ = false;
  double began_ = 0;  ///< the time at which the last act restarted the run
  Work put_aside_;    ///< cost of the integrators before the last act
  DiagnosticSet diagnostics_;
  Events events_;
  StepGuard guard_;
  Evidence evidence_;
  std::unique_ptr<Integrator> integrator_;
  IntegrationState state_;
  std::optional<ActiveMethod> method_;
  bool shows_discrete_energy_ = false;
  Solution outcome_;
  /// Rows of samples by steps, and of the section, including those that were not kept for lack of room.
  std::int64_t kept_ = 0, points_ = 0;
  struct Passage {
    RunState x;
    StepInfo step;
  };
  std::vector<Passage> passed_;  ///< through the plane of the section, within the last step
  Snapshots snapshots_;
  struct EndAtEvent {
    RunState x;
    std::size_t which;              ///< the watched expression that vanishes
    std::vector<std::size_t> also;  ///< others that vanish in the instant in which it acts
  };
  std::optional<EndAtEvent> ended_;
  ReturnCode cut_short_ = ReturnCode::completed;  ///< why the last step was not searched to its end
};

}  // namespace least
