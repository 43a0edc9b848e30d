#include "core/run/equal_steps.hpp"

#include <algorithm>
#include <cmath>

#include "core/run/damping_pole.hpp"

namespace least {
namespace {

/// most_rows_of bounds the number of states of a block that diagnostics see, if states are large: half a mebibyte of
/// them.
std::int64_t most_rows_of(const ProblemTraits& traits) {
  constexpr std::size_t numbers = 1 << 16;
  return static_cast<std::int64_t>(std::max<std::size_t>(numbers / (1 + traits.numbers), 8));
}

}  // namespace

BlockResult EqualSteps::advance(IntegrationState& state, StepTarget target, StepGuard& guard,
                                DiagnosticSet* diagnostics) {
  std::int64_t count = std::min(target.n, grid_.step_before(target.t)) - state.n;
  if (count <= 0) return {};
  if (const double pole = damping_pole(); pole < never) {
    constexpr double slack = 1e-9;  // of a step
    count = std::min(count, grid_.step_before(pole - slack * grid_.step) - state.n);
    if (count <= 0) return BlockResult::failed(StepStatus::singular);
  }
  if (on_series(state.n)) return advance_on_series(state, count, diagnostics);
  if (diagnostics)
    count = std::min({count, diagnostics->watches() ? watched_ : most_rows, most_rows_of(problem_.traits)});
  if (keeps_last_step_) {  // the last step is a block of its own, so that its start is known
    if (count > 1)
      if (const BlockResult result = take_steps(state, count - 1, guard, diagnostics);
          !result || (diagnostics && diagnostics->crossed()))
        return result;
    left_ = state.x;
    count = 1;
  }
  return take_steps(state, count, guard, diagnostics);
}

BlockResult EqualSteps::finish(IntegrationState& state, double end, StepGuard& guard) {
  if (!(state.x.t < end)) return {};
  const IntegrationState last = state;
  left_ = last.x;
  if (!(end < damping_pole())) return BlockResult::failed(StepStatus::singular);
  keep_stepper();
  BlockResult result;
  result.status = covered_by_series(state.n, end) ? from_series(state.x, end) : last_step(state.x, grid_.tail);
  state.x.t = end;
  ++state.n;
  if (result.status != StepStatus::ok) result.end = BlockEnd::step_failed;
  if (result && !is_finite_state(problem_.traits, state.x)) result.end = BlockEnd::not_finite;
  if (result && problem_.outside(state.x)) result.end = BlockEnd::left_domain;
  if (!result) {
    const Work tried = work();
    state = last;
    take_stepper_back();
    count_tried(tried);
  } else if (problem_.traits.has_frequency) {
    guard.see(problem_.frequency_squared(state.x) * grid_.step * grid_.step);
  }
  return result;
}

void EqualSteps::step_back(IntegrationState& state) {
  if (!(left_.t < state.x.t)) return;
  const Work tried = work();
  state = {left_, state.n - 1};
  take_stepper_back();
  count_tried(tried);
}

StepStatus EqualSteps::state_at(const IntegrationState& state, double t, RunState& x) const {
  const bool ahead = !(t < state.x.t);
  if (ahead ? covered_by_series(state.n, t) : along_series_ && state.n <= series_steps_) return from_series(x, t);
  x = ahead ? state.x : left_;
  const double part = t - x.t;
  const StepStatus status = part > 0 ? trial_step(ahead ? StepperAt::here : StepperAt::left, x, part) : StepStatus::ok;
  x.t = t;
  return status;
}

bool EqualSteps::starts_regularly(StateView x) {
  if (!problem_.traits.has_series) return along_series_;
  if (starts_at_singularity()) {
    double momentum = 0;
    for (std::size_t i = 0; i < problem_.traits.dof; ++i)
      momentum += x[problem_.traits.dof + i] * x[problem_.traits.dof + i];
    return x.t == 0 && momentum == 0;
  }
  along_series_ = problem_.starts_series(x);
  if (along_series_)
    series_steps_ = std::max<std::int64_t>(whole_steps(grid_.start, problem_.traits.series_until, grid_.step), 1);
  return along_series_;
}

BlockResult EqualSteps::check_start(StateView x, StepGuard& guard) const {
  if (grid_.steps > 0 && !of_rates_alone() && reaches_pole(x)) return BlockResult::failed(StepStatus::singular);
  if (problem_.traits.has_frequency) {
    guard.see(problem_.frequency_squared(x) * grid_.step * grid_.step);
    if (grid_.steps > 0 && guard.exceeded()) return {BlockEnd::too_fast};
  }
  return {};
}

double EqualSteps::discrete_energy(const IntegrationState& state) const {
  if (state.n == 0 || (along_series_ && state.n <= series_steps_)) return unknown;
  return energy_of_step(left_, state.n > grid_.steps ? grid_.tail : grid_.step);
}

std::optional<StrongDamping> EqualSteps::strong_damping(std::int64_t n) const {
  std::optional<StrongDamping> found;
  if (!problem_.traits.linear_contact) return found;
  const auto [flips, stiff] = damping_limits();
  if (flips == never && stiff == never) return found;
  constexpr std::int64_t most = 1000;
  n = std::min(n, grid_.steps) - grid_.first;
  if (const double steps = std::ceil(problem_.period() / grid_.step); steps > 0 && steps < double(n))
    n = static_cast<std::int64_t>(steps) + 1;
  const std::int64_t looks = std::min(n, most);
  for (std::int64_t k = 1; k <= looks && !(found && found->flips); ++k) {
    const auto step =
        static_cast<std::int64_t>(static_cast<double>(n) * static_cast<double>(k) / static_cast<double>(looks));
    const double t =
        grid_.time(grid_.first + std::max<std::int64_t>(step, 2));  // the damping may be singular at the start
    const double strength = problem_.damping(t) * grid_.step;
    const bool over = strength >= flips;
    if (over || (strength > stiff && !found)) found = {t, strength, over ? flips : stiff, over};
  }
  return found;
}

Work EqualSteps::work() const {
  const Work here = stepper_work();
  return {before_.forces + here.forces, before_.iterations + here.iterations};
}

bool EqualSteps::reaches_pole(StateView x) const {
  return problem_.traits.quadratic_contact &&
         -problem_.action_curvature() * x[2 * problem_.traits.dof] * grid_.step > 2;
}

double EqualSteps::damping_pole() {
  if (!damping_pole_) damping_pole_ = least::damping_pole(problem_, grid_.start, grid_.end);
  return *damping_pole_;
}

BlockResult EqualSteps::seen_block(IntegrationState& state, std::int64_t count, StepGuard& guard,
                                   DiagnosticSet* diagnostics) {
  if (!diagnostics) return block(state, count, guard, nullptr);
  if (!rows_)
    rows_ = std::make_unique_for_overwrite<double[]>(
        static_cast<std::size_t>(std::min(most_rows, most_rows_of(problem_.traits))) * (1 + problem_.traits.numbers));
  const BlockResult result = block(state, count, guard, rows_.get());
  if (result) diagnostics->see_signs(rows(count));
  return result;
}

BlockResult EqualSteps::take_steps(IntegrationState& state, std::int64_t count, StepGuard& guard,
                                   DiagnosticSet* diagnostics) {
  const std::int64_t first = state.n;
  keep(block_kept_, state, guard, diagnostics);
  const BlockResult result = seen_block(state, count, guard, diagnostics);
  if (result && !(diagnostics && diagnostics->crossed())) {
    if (diagnostics) diagnostics->take(rows(count));
    watched_ = std::min<std::int64_t>(2 * watched_, 256);
    return result;
  }
  if (result && count == 1) {
    diagnostics->take(rows(1));
    left_ = block_kept_.state.x;
    watched_ = 1;
    return result;
  }
  take_back(block_kept_, state, guard, diagnostics);
  const BlockResult again = replay(state, count, guard, diagnostics);
  watched_ = std::clamp<std::int64_t>(state.n - first, 1, 8);
  return again;
}

/// replay takes the same steps one by one, up to the first in which something happened.
BlockResult EqualSteps::replay(IntegrationState& state, std::int64_t count, StepGuard& guard,
                               DiagnosticSet* diagnostics) {
  for (; count > 0; --count) {
    keep(step_kept_, state, guard, diagnostics);
    left_ = state.x;
    const BlockResult result = seen_block(state, 1, guard, diagnostics);
    if (result && diagnostics) diagnostics->take(rows(1));
    if (result && !(diagnostics && diagnostics->crossed())) continue;
    if (!result) {
      const StepGuard seen = guard;  // including the step that went wrong
      const Work tried = work();
      take_back(step_kept_, state, guard, diagnostics);
      guard = seen;
      count_tried(tried);
    }
    return result;
  }
  return {};
}

void EqualSteps::keep(Snapshot& kept, const IntegrationState& state, const StepGuard& guard,
                      const DiagnosticSet* diagnostics) {
  keep_stepper();
  kept.state = state;
  kept.guard = guard;
  if (diagnostics) kept.signs = diagnostics->signs();
}
void EqualSteps::take_back(const Snapshot& kept, IntegrationState& state, StepGuard& guard,
                           DiagnosticSet* diagnostics) {
  take_stepper_back();
  state = kept.state;
  guard = *kept.guard;
  if (diagnostics) diagnostics->restore(kept.signs);
}
void EqualSteps::count_tried(const Work& tried) {
  const Work here = stepper_work();
  before_ = {tried.forces - here.forces, tried.iterations - here.iterations};
}

StepStatus EqualSteps::from_series(RunState& x, double t) const {
  const double until = std::min(t, problem_.traits.series_until);
  x = problem_.series_state(until);
  if (t > until)
    if (const StepStatus status = bound_step(x, t - until); status != StepStatus::ok) return status;
  x.t = t;
  return StepStatus::ok;
}

BlockResult EqualSteps::advance_on_series(IntegrationState& state, std::int64_t count, DiagnosticSet* diagnostics) {
  for (; count > 0 && on_series(state.n); --count) {
    RunState x = state.x;
    const bool last = state.n + 1 == grid_.steps && grid_.tail == 0;
    if (const StepStatus status = from_series(x, last ? grid_.end : grid_.time(state.n + 1)); status != StepStatus::ok)
      return BlockResult::failed(status);
    if (!is_finite_state(problem_.traits, x)) return {BlockEnd::not_finite};
    left_ = state.x;
    state = {x, state.n + 1};
    if (diagnostics) diagnostics->see(x);
    if (diagnostics && diagnostics->crossed()) break;
  }
  if (!on_series(state.n)) {
    before_ = work();
    bind_stepper(state.x);
  }
  return {};
}

}  // namespace least
