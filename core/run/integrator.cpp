#include "core/run/integrator.hpp"

namespace least {

double exit_time(const ProblemTable& problem, const Integrator& integrator, const IntegrationState& state,
                 double outside_at) {
  const auto inside = [&](double ahead) {
    RunState x = state.x;
    if (ahead > 0 && integrator.state_at(state, state.x.t + ahead, x) != StepStatus::ok) return -1.0;
    return problem.inside(x);
  };
  const double step = integrator.step_info(state).step_size;
  const double known = outside_at > state.x.t ? outside_at - state.x.t : std::numeric_limits<double>::infinity();
  double reach = std::min(step > 0 ? step : 1e-3, known);
  for (int k = 0; k < 60 && reach < known && inside(reach) > 0; ++k) reach = std::min(2 * reach, known);
  if (reach == known && inside(known) > 0) return outside_at;  // trial steps differ from the step that found it
  return state.x.t + root(inside, 0, reach);
}

}  // namespace least
