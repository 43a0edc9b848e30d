#include "core/run/crossings.hpp"

#include <algorithm>

namespace least {

void locate_sections(const ProblemTable& problem, const Integrator& integrator, const IntegrationState& state,
                     Events& events) {
  const auto at = [&](double t) {
    RunState x = state.x;
    integrator.state_at(state, t, x);
    return x;
  };
  RunState from = integrator.left();
  const double start = from.t, parts = integrator.parts();
  for (double part = 1; part <= parts; ++part) {
    const RunState to = part < parts ? at(start + part * (state.x.t - start) / parts) : state.x;
    events.locate(problem, from, to, at);
    from = to;
  }
}

void look_within(const Integrator& integrator, const IntegrationState& state, double until,
                 DiagnosticSet& diagnostics) {
  if (!diagnostics.looks_within()) return;
  diagnostics.look_again();
  const double from = until > state.x.t ? state.x.t : integrator.left().t, parts = integrator.parts();
  for (double part = 1; part < parts; ++part) {
    RunState x = state.x;
    if (integrator.state_at(state, from + part * (until - from) / parts, x) == StepStatus::ok) diagnostics.look(x);
  }
}

std::vector<std::pair<Zero, RunState>> watched_zeros(const ProblemTable& problem, const Integrator& integrator,
                                                     const IntegrationState& state, Watch& watch, const RunState& from,
                                                     const RunState& to, const KeepGoing& keep_going) {
  if (watch.empty()) return {};
  const Measures& measures = watch.measures();
  const auto at = [&](double t, RunState& x) {
    x = state.x;
    return integrator.state_at(state, t, x) == StepStatus::ok && !problem.outside(x);
  };
  const auto observe_at = [&](double t, double* observed) {
    RunState x;
    if (!keep_going() || !at(t, x)) return false;
    std::ranges::copy(observe(problem, x, measures), observed);
    return true;
  };
  const int pieces = std::max(integrator.parts() / 4, 1);  // a search evaluates four points of each piece
  std::vector<std::pair<Zero, RunState>> found;
  for (const Zero& zero : watch.locate(observe(problem, from, measures).data(), from.t,
                                       observe(problem, to, measures).data(), to.t, observe_at, pieces)) {
    RunState x = zero.t > from.t ? to : from;
    if (zero.t > from.t && zero.t < to.t) at(zero.t, x);
    found.emplace_back(zero, x);
  }
  return found;
}

std::vector<std::size_t> reached_at_end(const ProblemTable& problem, const Integrator& integrator,
                                        const IntegrationState& state, const Watch& watch) {
  if (watch.empty()) return {};
  const RunState& end = state.x;
  RunState before = integrator.left();
  // A state shortly before the end: further back the expression may have turned.
  if (const double last = end.t - 0x1p-20 * (end.t - before.t); last < end.t) integrator.state_at(state, last, before);
  const Measures& measures = watch.measures();
  return watch.reached(observe(problem, before, measures).data(), before.t, observe(problem, end, measures).data(),
                       end.t);
}

}  // namespace least
