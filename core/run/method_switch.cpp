#include "core/run/method_switch.hpp"

#include <algorithm>

namespace least {
namespace {

std::string_view coordinate(const ProblemCard& problem, const ActiveMethod& course) {
  if (course.parameter < 0) return {};
  return problem.variables[static_cast<std::size_t>(course.parameter)].name;
}
std::string_view mode(const ActiveMethod& course) { return mode_names[static_cast<std::size_t>(course.mode)]; }

}  // namespace

Report method_switch(const ProblemCard& problem, double t, std::span<const double> q, const ActiveMethod& was,
                     const ActiveMethod& now, const SwitchJumps& jumps) {
  const bool switched = was.mode != now.mode;
  std::vector<Report> event, at;
  event.reserve(9);
  at.reserve(q.size());
  event.push_back({"t", t});
  event.push_back(words("kind", switched ? "switch" : "parameter"));
  event.push_back(words("from", switched ? mode(was) : coordinate(problem, was)));
  event.push_back(words("to", switched ? mode(now) : coordinate(problem, now)));
  event.push_back(words("parameter", coordinate(problem, now)));
  for (std::size_t i = 0; i < q.size(); ++i)
    if (!problem.variables[i].hidden) at.push_back({problem.variables[i].name, q[i]});
  event.push_back({"at", std::move(at)});
  if (switched) {
    std::vector<Report> momenta;
    momenta.reserve(jumps.invariants.size());
    for (std::size_t i = 0; i < std::min(jumps.invariants.size(), problem.invariants.size()); ++i)
      momenta.push_back({problem.invariants[i].name, jumps.invariants[i]});
    event.push_back({"energy_jump", jumps.energy});
    event.push_back({"discrete_energy_jump", jumps.discrete_energy});
    event.push_back({"momentum_jumps", std::move(momenta)});
  }
  return {"", std::move(event)};
}

Report method_switch(const ProblemCard& card, const ProblemTable& problem, const RunState& left, const RunState& x,
                     const ActiveMethod& was, const ActiveMethod& now, double discrete_energy_jump) {
  StateNumbers change(problem.traits.invariants), before(problem.traits.invariants);
  problem.invariants(x, change.data());
  problem.invariants(left, before.data());
  for (std::size_t i = 0; i < change.size(); ++i) change[i] -= before[i];
  const SwitchJumps jumps{
      problem.energy(x) - problem.energy(left), discrete_energy_jump, {change.data(), change.size()}};
  return method_switch(card, left.t, {left.numbers.data(), problem.traits.dof}, was, now, jumps);
}

}  // namespace least
