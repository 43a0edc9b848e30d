#include "core/catalogue/catalogue.hpp"
#include "core/variations/doubt.hpp"
#include "core/variations/rows.hpp"
#include "core/variations/scheme_map.hpp"
#include "core/variations/start.hpp"
#include "core/variations/structure.hpp"
#include "core/variations/varied_motion.hpp"

namespace least::variations {
namespace {

/// whole_steps_of returns the numbers of steps of the first times, all those before the first one within a step.
std::vector<std::int64_t> whole_steps_of(const Grid& grid, std::span<const double> times) {
  std::vector<std::int64_t> steps;
  for (const double t : times) {
    const std::int64_t step = grid.step_before(t);
    if (grid.time(step) != t) break;
    steps.push_back(step);
  }
  return steps;
}

/// walk_all walks along all directions of a request. Derivatives are stored direction by direction.
Walked walk_all(Walk on, const SensitivitiesAsked& asked, const Start& start) {
  Walked all;
  for (const Quantity& by : asked.by) {
    const std::vector<double> slope = start.slope(by);
    const auto moved = by.kind == Quantity::Kind::parameter ? std::optional(by.index) : std::nullopt;
    on.slope = slope;
    Walked walked = walk(on, *asked.equations, moved);
    if (!walked.reason.empty()) return walked;
    all.slopes.resize(walked.slopes.size());
    for (std::size_t k = 0; k < all.slopes.size(); ++k)
      all.slopes[k].insert(all.slopes[k].end(), walked.slopes[k].begin(), walked.slopes[k].end());
    all.states = std::move(walked.states);
  }
  return all;
}

/// map_of_steps returns the map of the scheme between two numbers of steps.
std::optional<TangentMap> map_of_steps(const Walk& whole, const SensitivitiesAsked& asked, const Start& start,
                                       double from, double to, const std::vector<double>& state) {
  const auto first = static_cast<std::int64_t>(from);
  Grid grid(whole.request, whole.grid.step, whole.grid.time(first), first);
  grid.steps = static_cast<std::int64_t>(to);
  grid.tail = grid.steps == whole.grid.steps ? whole.grid.tail : 0;
  const Walked all = walk_all({whole.request, whole.scheme, grid, state, {}, {}, whole.keep_going}, asked, start);
  if (!all.reason.empty()) return std::nullopt;
  return tangent_map(*asked.equations, state, all.states.back(), all.slopes.back());
}

/// doubt_by_motion compares the derivatives of a scheme's map with those of the motion. Where forces jump the former
/// may be exact and say nothing of the motion, because a step across a jump does not depend on where in it the jump
/// lies. Differences below a tenth are an error of the scheme, and no reason for doubt.
Doubt doubt_by_motion(const Request& request, SensitivitiesAsked asked, const Solution& outcome, const Slopes& of_map,
                      const KeepGoing& keep_going) {
  constexpr double close = 1e-12, much = 0.1;
  asked.order = 1;
  asked.whole_start = false;
  const Sensitivities of_motion = sensitivities_of_motion(request, asked, outcome, {}, close, keep_going);
  if (of_motion.final.empty() || !(of_motion.uncertainty < much)) return {0};
  const double apart = disagreement({of_motion.final}, {of_map});
  return {apart > much ? apart : 0};
}

}  // namespace

Sensitivities sensitivities_of_scheme(const Request& request, const SensitivitiesAsked& asked, const Solution& outcome,
                                      std::span<const double> times, const KeepGoing& keep_going) {
  const ParametricScene& equations = *asked.equations;
  const Scene& scene = *request.scene;
  const SchemeCard& scheme = schemes()[request.scheme];
  const std::size_t size = equations.components, count = asked.by.size();
  const Start start(scene, asked);
  Sensitivities found;
  for (const std::size_t place : equations.variables) found.rows.push_back(scene.card().variables[place].name);
  for (const Report& report : outcome.events)
    found.events.emplace_back(name_of_event(report), std::vector<double>(count, unknown));
  Grid grid(request, request.setting("step", scheme));
  std::vector<std::int64_t> looks;
  Request beside = request;
  const bool stopped = outcome.stop.reason != ReturnCode::completed || !outcome.event.empty();
  if (stopped) {
    found.reason = "the run ended before its end, between or at a step that may be another for its neighbours";
    looks = whole_steps_of(grid, times);
    if (looks.empty()) return found;
    // The last of these samples takes the place of the end
    beside.until_steps = true;
    beside.steps = grid.steps = looks.back();
    grid.tail = 0;
    looks.pop_back();
  } else {
    for (const double t : times)
      if (t < outcome.t) looks.push_back(grid.step_before(t));
  }
  const std::size_t rows = looks.size() + 1;  // direction by direction, in rows, and for one direction
  found.held.add(2 * bytes_of_lists(rows, size * count) + bytes_of_lists(rows, 2 * size));

  const Walk on{request, scheme, grid, start.state(), {}, looks, keep_going};
  const Walked all = walk_all(on, asked, start);
  if (!all.reason.empty()) {
    found.reason = all.reason;
    return found;
  }
  if (stopped) {
    for (const Slopes& slopes : all.slopes) found.samples.push_back(in_rows(equations, slopes));
  } else {
    found.final = in_rows(equations, all.slopes.back());
    for (const double t : times)
      found.samples.push_back(t < outcome.t ? in_rows(equations, all.slopes[found.samples.size()]) : found.final);
    const auto map_of = [&](double from, double to, const std::vector<double>& state) {
      return map_of_steps(on, asked, start, from, to, state);
    };
    if (asked.whole_start)
      add_structure(equations, tangent_map(equations, start.state(), all.states.back(), all.slopes.back()),
                    {0, static_cast<double>(grid.steps), true, map_of}, found);
  }

  if (!found.events.empty())
    add_reason("times of events have derivatives along the motion alone: \"of\": \"motion\"", found);

  found.uncertainty = 0;
  add_doubt(doubt_by_runs(Neighbours(beside, asked, start), equations, all.slopes.back(), keep_going), found);
  if (!stopped && switches(equations))
    add_doubt(doubt_by_motion(request, asked, outcome, found.final, keep_going), found);
  return found;
}

}  // namespace least::variations
