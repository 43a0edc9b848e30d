// One run of one problem by one scheme, with equal steps or the scheme's own clock: samples, diagnostics and the end,
// around blocks of steps of an integrator.
#include "core/run/run.hpp"

#include <algorithm>
#include <cmath>

#include "core/run/hermite.hpp"
#include "core/run/kink_start.hpp"
#include "core/run/method_switch.hpp"
#include "core/run/one_run.hpp"
#include "core/run/start_check.hpp"

namespace least {

bool Run::initialize() {
  if (const auto objection = start_objection(problem_, state_.x, end_, integrator_->starts_regularly(state_.x)))
    return stop(objection->reason, objection->detail, objection->singular_at);
  if (const std::string why = integrator_->unsupported_reason(); !why.empty()) return stop(ReturnCode::singular, why);
  if (scheme_.find("tolerance") && begins_on_kink(scene_, problem_, state_.x, end_ - state_.x.t))
    return stop(ReturnCode::singular, std::string(starts_on_kink).append(" that become ever shorter"));
  diagnostics_.start(state_.x);
  evidence_.start(problem_, state_.x);
  if (diagnostics_.keeps_states()) snapshots_.see(state_);
  if (!save_due(last_step()) || (drawn_ < infinite && !save(state_.x, last_step()))) return false;
  const BlockResult result = integrator_->check_start(state_.x, guard_);
  return result || fail(result);
}

bool Run::advance_block() {
  const std::int64_t n = state_.n;
  if (!save_passed() || !within_step_limit()) return false;
  const double due = this->due() < end_ ? this->due() : infinite;
  const StepInfo before = fixed_ && due < infinite ? last_step() : StepInfo();
  const StepTarget target{
      std::min({n + (drawn_ < infinite ? 1 : budget_.block()), request_.limits.steps, last_step_, schedule_.step(),
                fixed_ && due < infinite ? step_towards(due) : SaveSchedule::never,
                diagnostics_.keeps_states() ? snapshots_.next(n) : SaveSchedule::never, evidence_.next(n)}),
      std::min({loop_end_, own_clock_end(), fixed_ ? infinite : due})};
  const BlockResult result =
      integrator_->advance(state_, target, guard_, diagnostics_.sees_steps() ? &diagnostics_ : nullptr);
  if (result && !(state_.x.t < own_clock_end())) return stop_at_pole();
  const bool crossed = diagnostics_.clear_crossed();
  if (crossed) locate_sections();
  record_method_switch();
  if (crossed) locate_watched(integrator_->left(), state_.x);
  if (RunState x = state_.x;
      !fixed_ && x.t > end_ && !ended_ && !watch_.empty())  // the part of the step up to the end was not searched
    if (integrator_->state_at(state_, end_, x) == StepStatus::ok) locate_watched(integrator_->left(), x);
  if (!searched()) return false;
  if (!ended_) diagnostics_.resume(state_.x);
  if (state_.n > n && state_.x.t <= end_) {
    if (diagnostics_.keeps_states()) snapshots_.see(state_);
    evidence_.see(problem_, state_);
  }
  const bool drawn = state_.n == n || state_.x.t > end_ || draw(state_.x.t);
  return drawn && save_due(before) && (result || fail(result)) &&
         within_budget(std::max<std::int64_t>(state_.n - n, 1));
}

void Run::record_method_switch() {
  const auto now = integrator_->method();
  if (now == method_) return;
  const auto was = std::exchange(method_, now);
  if (state_.n == 1 && now->mode == was->mode) return;  // the first step only chose its parameter
  if (!events_.room(outcome_.events.size())) return;
  if (problem_.traits.conservative)
    outcome_.add_event(method_switch(card_, problem_, integrator_->left(), state_.x, *was, *now,
                                     integrator_->discrete_energy_jump(state_, *was)));
}

std::int64_t Run::step_towards(double due) const {
  const std::int64_t before = grid_.step_before(due);
  return before > state_.n ? before : grid_.step_after(due);
}

bool Run::save_due(const StepInfo& before) {
  while (due() < end_ && due() <= state_.x.t) {
    RunState x = state_.x;
    StepStatus status = integrator_->state_at(state_, due(), x);
    // A shorter step may fail although the whole step succeeded; recording a state must not change a run.
    if (status != StepStatus::ok && due() < state_.x.t) status = between_ends_of_step(due(), x);
    if (status != StepStatus::ok || problem_.outside(x)) {  // a long step may leave the domain and return
      if (due() < state_.x.t) step_back();
      return status == StepStatus::ok ? leave_domain(due()) : fail(BlockResult::failed(status));
    }
    if (!save_next(x, fixed_ && x.t < state_.x.t ? before : last_step())) return false;
  }
  for (; schedule_.step() == state_.n && state_.x.t <= end_; schedule_.next())
    if (kept_++ < most_rows_ && !save(state_.x, last_step())) return false;
  return true;
}

StepStatus Run::between_ends_of_step(double t, RunState& x) const {
  x = HermitePath(problem_, integrator_->left(), state_.x)(t);
  return std::ranges::all_of(x.numbers, [](double number) { return std::isfinite(number); })
             ? StepStatus::ok
             : StepStatus::solver_failed;
}

bool Run::draw(double t) {
  if (!(t > drawn_)) return true;
  RunState x = state_.x;
  if (t != x.t && integrator_->state_at(state_, t, x) != StepStatus::ok) return true;  // the next step will report it
  const StepInfo step = last_step();
  const double share = std::isfinite(planned_end_) ? (t - scene_.start) / (planned_end_ - scene_.start) : unknown;
  const std::size_t parts = std::max<std::size_t>(writer_.parts(x, step, share), integrator_->parts());
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

Solution run(const RunBackend& backend, const Request& request, const std::vector<Column>& columns, RowSink& sink,
             const std::atomic<bool>& cancelled) {
  return Run(backend, request, columns, sink, cancelled).solve();
}

}  // namespace least
