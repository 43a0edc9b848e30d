// One run of one problem by one scheme, whatever sets its clock: the samples, the diagnostics and the end, around
// blocks of steps that an integrator takes.
#include "core/run/run.hpp"

#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "core/run/budget.hpp"
#include "core/run/crossings.hpp"
#include "core/run/diagnostics/error.hpp"
#include "core/run/integrator.hpp"
#include "core/run/messages.hpp"
#include "core/run/method_switch.hpp"
#include "core/run/save_schedule.hpp"
#include "core/run/snapshots.hpp"
#include "core/run/standstill.hpp"
#include "core/run/start_check.hpp"
#include "core/run/stop_reason.hpp"
#include "core/run/trajectory_writer.hpp"
#include "core/run/warnings.hpp"

namespace least {
namespace {

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
        writer_(problem_, request, columns, sink),
        budget_(request.limits.seconds, cancelled,
                [this] { return writer_.report(std::min(state_.x.t, end_), state_.n); }),
        watch_(request),
        diagnostics_(backend, request, watch_, budget_.shortly()),
        events_(static_cast<std::size_t>(most_rows_)),
        guard_(request.scheme, request.settings, guarded_damping(problem_) * grid_.step, problem_.traits.has_frequency,
               problem_.traits.constant_frequency, request.probe),
        evidence_(problem_.traits, fixed_ ? std::optional(grid_.steps) : std::nullopt, request.control) {}

  Solution solve() {
    state_.x = problem_.start(scene_.initial, scene_.start);
    integrator_ = backend_.bind(request_, state_.x, grid_, end_);
    method_ = integrator_->method();
    shows_discrete_energy_ = std::ranges::any_of(
        request_.columns, [&](std::size_t i) { return request_.column(i).name == "discrete_energy"; });
    if (shows_discrete_energy_ || drawn_ < infinite || !watch_.empty()) integrator_->keep_last_step();
    budget_.start(weight_of_force(*scene_.mechanics));
    if (initialize()) {
      while (going() && !arrived() && advance_block()) continue;
      if (going()) finish();
    }
    return conclude();
  }

 private:
  static constexpr double infinite = std::numeric_limits<double>::infinity();

  bool going() const { return outcome_.stop.reason == ReturnCode::completed; }
  bool arrived() const { return ended_ || state_.n == last_step_ || !(state_.x.t < loop_end_); }
  bool stop(ReturnCode reason, std::string detail, double singular_at = unknown) {
    if (!fixed_ && state_.x.t > end_) step_back();
    if (going()) outcome_.stop = {reason, std::move(detail), state_.x.t, state_.n, {}};
    if (std::isfinite(singular_at)) outcome_.stop.singular_at = singular_at;
    return false;
  }
  void warn(std::string_view code, std::string detail) { outcome_.warnings.push_back({code, std::move(detail)}); }
  bool keep_going() { return budget_.look() == ReturnCode::completed; }
  bool within_budget(std::int64_t steps) {
    const ReturnCode reason = budget_.passed(steps);
    if (reason == ReturnCode::deadline) return stop(reason, messages::deadline(request_.limits.seconds));
    return reason == ReturnCode::completed || stop(reason, "the run was cancelled");
  }
  bool within_step_limit() {
    return state_.n != request_.limits.steps ||
           stop(ReturnCode::step_limit, messages::step_limit(request_.limits.steps));
  }

  bool initialize() {
    if (const auto objection = start_objection(problem_, state_.x, end_, integrator_->starts_regularly(state_.x)))
      return stop(objection->reason, objection->detail, objection->singular_at);
    if (const std::string why = integrator_->unsupported_reason(); !why.empty()) return stop(ReturnCode::singular, why);
    diagnostics_.start(state_.x);
    evidence_.start(problem_, state_.x);
    if (diagnostics_.keeps_states()) snapshots_.see(state_);
    if (!save_due() || (drawn_ < infinite && !save(state_.x, last_step()))) return false;
    const BlockResult result = integrator_->check_start(state_.x, guard_);
    return result || fail(result);
  }

  /// One block of steps and what falls due at its end.
  bool advance_block() {
    const std::int64_t n = state_.n;
    if (!within_step_limit()) return false;
    const double due = schedule_.time() < end_ ? schedule_.time() : infinite;
    const StepTarget target{
        std::min({n + (drawn_ < infinite ? 1 : budget_.block()), request_.limits.steps, last_step_, schedule_.step(),
                  looks_first() && due < infinite ? grid_.step_after(due) : SaveSchedule::never,
                  diagnostics_.keeps_states() ? snapshots_.next(n) : SaveSchedule::never, evidence_.next(n)}),
        std::min(loop_end_, looks_first() ? infinite : due)};
    const BlockResult result =
        integrator_->advance(state_, target, guard_, diagnostics_.sees_steps() ? &diagnostics_ : nullptr);
    const bool crossed = diagnostics_.clear_crossed();
    if (crossed) locate_sections();
    record_method_switch();
    if (crossed) locate_watched(integrator_->left(), state_.x);
    if (RunState x = state_.x;
        !fixed_ && x.t > end_ && !ended_ && !watch_.empty())  // beyond the end nothing was looked at
      if (integrator_->state_at(state_, end_, x) == StepStatus::ok) locate_watched(integrator_->left(), x);
    if (!ended_) diagnostics_.resume(state_.x);
    if (state_.n > n && state_.x.t <= end_) {
      if (diagnostics_.keeps_states()) snapshots_.see(state_);
      evidence_.see(problem_, state_);
    }
    const bool drawn = state_.n == n || state_.x.t > end_ || draw(state_.x.t);
    return drawn && save_due() && (result || fail(result)) && within_budget(std::max<std::int64_t>(state_.n - n, 1));
  }

  /// The zeros of sections within the last step.
  void locate_sections() {
    if (diagnostics_.watches_sections()) least::locate_sections(problem_, *integrator_, state_, events_);
  }
  /// Events between two states of the last step, or of the next one, up to the first that ends the run.
  void locate_watched(const RunState& from, const RunState& to) {
    for (const auto& [zero, x] : watched_zeros(problem_, *integrator_, state_, watch_, from, to)) {
      add_event(zero, x);
      if (!watch_.ends(zero.which)) continue;
      ended_.emplace(x, zero.which);
      end_ = x.t;
    }
  }
  void add_event(const Zero& zero, const RunState& x) {
    if (events_.room(32 * outcome_.events.size()))  // as many numbers take the memory of one
      outcome_.add_event(watch_.event(zero, card_, shown_variables(request_, problem_.traits, x)));
  }
  /// The last step is taken back, and what was found in it.
  void step_back() {
    integrator_->step_back(state_);
    std::erase_if(outcome_.events, [&](const Report& event) { return Watch::time(event) > state_.x.t; });
    if (!ended_ || !(ended_->first.t > state_.x.t)) return;
    ended_.reset();
    end_ = planned_end_;
  }
  /// A step that was taken by another method than the one before it is an event, at the state it began with.
  void record_method_switch() {
    const auto now = integrator_->method();
    if (now == method_) return;
    const auto was = std::exchange(method_, now);
    if (state_.n == 1 && now->mode == was->mode) return;  // the first step only made its choice
    if (!events_.room(outcome_.events.size())) return;
    if (problem_.traits.conservative)
      outcome_.add_event(method_switch(card_, problem_, integrator_->left(), state_.x, *was, *now,
                                       integrator_->discrete_energy_jump(state_, *was)));
  }

  /// Whether samples wait until the step they lie in has been looked at, for it may end the run.
  bool looks_first() const { return fixed_ && watch_.may_end(); }
  bool known(double t) const { return looks_first() ? t <= state_.x.t : integrator_->reaches(state_, t); }
  /// The samples before the end that can be told from here.
  bool save_due() {
    for (; schedule_.time() < end_ && known(schedule_.time()); schedule_.next()) {
      RunState x = state_.x;
      const StepStatus status = integrator_->state_at(state_, schedule_.time(), x);
      if (status != StepStatus::ok || problem_.outside(x)) {  // a long step may lead out of the domain and back
        if (schedule_.time() < state_.x.t) step_back();
        return status == StepStatus::ok ? leave_domain(schedule_.time()) : fail(BlockResult::failed(status));
      }
      if (!save(x, last_step()) || !within_budget(1)) return false;
    }
    for (; schedule_.step() == state_.n && state_.x.t <= end_; schedule_.next())
      if (kept_++ < most_rows_ && !save(state_.x, last_step())) return false;
    return true;
  }
  /// How the last step, which ended in the state, was taken.
  StepInfo last_step() const {
    StepInfo step = integrator_->step_info(state_);
    if (shows_discrete_energy_) step.discrete_energy = integrator_->discrete_energy(state_);
    return step;
  }
  bool save(const RunState& x, const StepInfo& step) {
    const auto written = writer_.write_row(x, step);
    if (written == TrajectoryWriter::Written::not_finite)
      return stop(ReturnCode::not_finite, messages::column(writer_.wrong_column()));
    return written == TrajectoryWriter::Written::yes || receiver_is_gone();
  }
  /// Samples from the last one to the time t, within the last step or one ahead, where they are to draw a curve.
  bool draw(double t) {
    if (!(t > drawn_)) return true;
    RunState x = state_.x;
    if (t != x.t && integrator_->state_at(state_, t, x) != StepStatus::ok) return true;  // what comes next tells of it
    const StepInfo step = last_step();
    const std::size_t parts = std::max<std::size_t>(writer_.parts(x, step), integrator_->parts());
    const double from = drawn_;
    for (std::size_t k = 1; k <= parts; ++k) {
      RunState y = x;
      const double here = k < parts ? from + (t - from) * (double(k) / double(parts)) : t;
      const bool known = k == parts || integrator_->state_at(state_, here, y) == StepStatus::ok;
      if (!known || problem_.outside(y)) continue;
      drawn_ = here;
      if (!save(y, step) || !within_budget(1)) return false;
    }
    return true;
  }
  bool receiver_is_gone() { return stop(ReturnCode::cancelled, "the receiver of the samples went away"); }

  /// The state at the end, by a shorter step or within the last one, and the samples there.
  void finish() {
    if (ended_) return finish_at_event();
    if (fixed_ && grid_.tail > 0 && !within_step_limit()) return;
    if (!fixed_ && end_ < infinite && !draw(end_)) return;
    const double before = state_.x.t;
    StepInfo step = last_step();
    if (const BlockResult result = integrator_->finish(state_, end_, guard_); !result) {
      step_back();
      if (!fail(result)) return;
    } else if (state_.x.t != before && diagnostics_.sees_steps()) {
      look_within(*integrator_, state_, end_, diagnostics_);
      diagnostics_.see(state_.x);
      const bool crossed = diagnostics_.clear_crossed();
      if (crossed || integrator_->parts() > 1) locate_sections();
      if (crossed && fixed_) locate_watched(integrator_->left(), state_.x);
      if (!ended_) diagnostics_.resume(state_.x);
    }
    if (ended_) return finish_at_event();
    for (const std::size_t which : reached_at_end(problem_, *integrator_, state_, watch_)) {
      add_event({state_.x.t, which}, state_.x);
      if (watch_.ends(which) && outcome_.event.empty()) outcome_.event = watch_.name(which);
    }
    if (fixed_) step.discrete_energy = last_step().discrete_energy;  // of the shorter step
    if (end_ < infinite && (!fixed_ || draw(end_))) save_rest(state_.x, step);
  }
  /// The samples that are left up to the state x, in which the run ends.
  bool save_rest(const RunState& x, const StepInfo& step) {
    for (; schedule_.time() <= x.t; schedule_.next()) {
      RunState y = x;
      const StepStatus status =
          schedule_.time() < x.t ? integrator_->state_at(state_, schedule_.time(), y) : StepStatus::ok;
      if (status != StepStatus::ok) return fail(BlockResult::failed(status));
      if (!save(y, step) || !within_budget(1)) return false;
    }
    return true;
  }

  /// The end at an event within the last step, or in the part of the next one that stays in the domain. Samples go by
  /// time up to it, by steps up to the last one before it; diagnostics take it for the end of that step.
  void finish_at_event() {
    const auto [x, which] = *ended_;
    if (draw(x.t)) save_rest(x, last_step());
    look_within(*integrator_, state_, x.t, diagnostics_);
    if (x.t > state_.x.t) ++state_.n;
    state_.x = x;
    diagnostics_.end(x);
    if (going()) outcome_.event = watch_.name(which);
  }

  /// What lies ahead of the state went wrong.
  bool fail(const BlockResult& result) {
    if (result.end == BlockEnd::left_domain) return leave_domain();
    if (result.end == BlockEnd::too_fast) return stop_as_unstable();
    const double when = result.end == BlockEnd::not_finite && fixed_ ? unknown : true_singularity();
    const auto why = stop_reason(result, fixed_, method_.has_value(), integrator_->failure(), when);
    const double singular_at = std::isfinite(why.singular_at)
                                   ? why.singular_at
                                   : singular_time(backend_, request_, result.status, state_.x.t, grid_.step,
                                                   integrator_->work().forces, [this] { return keep_going(); });
    return stop(why.reason, why.detail, singular_at);
  }

  /// When the motion that began at the start becomes infinite, if it does so near here; else unknown.
  double true_singularity() {
    if (problem_.traits.quadratic_contact) {
      if (request_.probe) return unknown;
      // Of steps that adapt the mean: the last ones before an end are as short as time can tell.
      const bool adapts = !fixed_ && state_.n > 0;
      const double step = adapts ? (state_.x.t - scene_.start) / static_cast<double>(state_.n) : grid_.step;
      if (step > 0)
        return scene_.mechanics->blow_up_time(scene_, state_.x.t + 10 * step, step, [this] { return keep_going(); });
    }
    return unknown;
  }
  bool stop_as_unstable() {
    if (request_.probe) return stop(ReturnCode::unstable_step, {});
    const double ratio = guard_.largest();
    const auto known = stable_steps(request_.scheme, request_.settings, ratio / nominal_step(),
                                    guarded_damping(problem_), nominal_step());
    return stop(ReturnCode::unstable_step, messages::unstable(ratio, guard_.bound(), known.limit));
  }
  double nominal_step() const { return request_.setting("step", scheme_); }
  /// The next step leads out of the domain, or is outside on its way, at `outside_at`: to where it does, or to the end.
  bool leave_domain(double outside_at = unknown) {
    const double when = exit_time(problem_, *integrator_, state_, outside_at);
    RunState x = state_.x;
    if (!watch_.empty() && integrator_->state_at(state_, std::min(when, end_), x) == StepStatus::ok)
      locate_watched(state_.x, x);
    const double until = std::min(when, end_);
    StepInfo partial = last_step();
    if (!fixed_) partial.step_size = until - state_.x.t;
    for (; schedule_.time() < until; schedule_.next()) {
      const StepStatus status = integrator_->state_at(state_, schedule_.time(), x);
      if (status != StepStatus::ok) return fail(BlockResult::failed(status));
      if (problem_.outside(x)) break;
      if (!save(x, partial) || !within_budget(1)) return false;
    }
    if (ended_) return true;
    if (const StepStatus status = integrator_->state_at(state_, until, x); status != StepStatus::ok)
      return fail(BlockResult::failed(status));
    if (!draw(until)) return false;
    if (when > end_) {
      state_ = {x, state_.n + 1};
      diagnostics_.end(x);
      return true;
    }
    if (diagnostics_.watches_sections()) events_.add(0, false, when, x[0]);
    return stop(ReturnCode::left_domain, messages::left_domain(when), when);
  }
  Solution conclude() {
    const Work work = integrator_->work();
    outcome_.cost = {state_.n, work.forces, work.iterations, budget_.seconds()};  // what follows is not part of it
    if (!writer_.finish(budget_.half())) receiver_is_gone();
    warn_of_the_run();
    if (writer_.lacks_truth()) warn_of_missing_reference(outcome_.warnings);
    outcome_.t = state_.x.t;
    outcome_.final = shown_variables(request_, problem_.traits, state_.x);
    if (request_.diagnostics.empty()) return std::move(outcome_);
    const RunEnd end{backend_,
                     scene_,
                     request_,
                     scheme_,
                     state_.x,
                     snapshots_.states(),
                     events_,
                     {[this] { return keep_going(); }, [this] { return request_.limits.seconds - budget_.seconds(); },
                      budget_.cancelled()},
                     outcome_.warnings};
    outcome_.diagnostics = diagnostics_.reports(end);
    return std::move(outcome_);
  }

  void warn_of_the_run() {
    if (request_.probe) return;
    if (kept_ > most_rows_) warn("samples_truncated", "more rows of columns than limits.samples; the first are kept");
    watch_.warn(outcome_.warnings);
    evidence_.finish(problem_, state_);
    const KeepGoing shortly = budget_.shortly();
    warn_of_run({backend_, request_, scheme_, state_, grid_.step, *integrator_, guard_, evidence_, shortly},
                outcome_.warnings);
    if (events_.full()) warn("events_truncated", "more events than limits.samples has room for; the first are listed");
  }

  const RunBackend& backend_;
  const Request& request_;
  const ProblemTable& problem_ = backend_.table();
  const Scene& scene_ = *request_.scene;
  const ProblemCard& card_ = scene_.card();
  const SchemeCard& scheme_ = scene_.mechanics->schemes()[request_.scheme];
  bool fixed_ = !scheme_.own_clock;  ///< steps are of equal length, those of grid_; else its step is 0
  Grid grid_;
  double loop_end_;  ///< steps go on until one reaches this time; infinite where their number says when to end
  double end_;       ///< the time of the final state; infinite where it is not known beforehand
  const double planned_end_ = end_;
  std::int64_t last_step_;  ///< or until there are this many
  SaveSchedule schedule_;
  double drawn_;  ///< until when samples draw a curve; infinite where they do not
  TrajectoryWriter writer_;
  const std::int64_t most_rows_ = request_.most_rows();
  Budget budget_;
  Watch watch_;
  DiagnosticSet diagnostics_;
  Events events_;
  StepGuard guard_;
  Evidence evidence_;
  std::unique_ptr<Integrator> integrator_;
  IntegrationState state_;
  std::optional<ActiveMethod> method_;
  bool shows_discrete_energy_ = false;
  Solution outcome_;
  std::int64_t kept_ = 0;
  Snapshots snapshots_;
  std::optional<std::pair<RunState, std::size_t>> ended_;  ///< at an event: the state there, and what vanishes
};

}  // namespace

Solution run(const RunBackend& backend, const Request& request, const std::vector<Column>& columns, RowSink& sink,
             const std::atomic<bool>& cancelled) {
  return Run(backend, request, columns, sink, cancelled).solve();
}

}  // namespace least
