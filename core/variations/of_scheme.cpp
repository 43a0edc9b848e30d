#include "core/catalogue/catalogue.hpp"
#include "core/variations/doubt.hpp"
#include "core/variations/rows.hpp"
#include "core/variations/scheme_map.hpp"
#include "core/variations/start.hpp"

namespace least::variations {
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
  if (outcome.stop.reason != ReturnCode::completed || !outcome.event.empty()) {
    found.reason = "the run ended before its end, between or at a step that may be another for its neighbours";
    return found;
  }
  const Grid grid(request, request.setting("step", scheme));
  std::vector<std::int64_t> looks;
  for (const double t : times)
    if (t < outcome.t) looks.push_back(grid.step_before(t));
  const std::size_t rows = looks.size() + 1;  // direction by direction, in rows, and for one direction
  found.held.add(2 * bytes_of_lists(rows, size * count) + bytes_of_lists(rows, 2 * size));

  std::vector<Slopes> all(looks.size() + 1);
  std::vector<double> end;
  for (const Quantity& by : asked.by) {
    const std::vector<double> slope = start.slope(by);
    const auto moved = by.kind == Quantity::Kind::parameter ? std::optional(by.index) : std::nullopt;
    const Walk on{request, scheme, grid, start.state(), slope, looks, keep_going};
    const Walked walked = walk(on, equations, moved);
    if (!walked.reason.empty()) {
      found.reason = walked.reason;
      return found;
    }
    for (std::size_t k = 0; k < all.size(); ++k)
      all[k].insert(all[k].end(), walked.slopes[k].begin(), walked.slopes[k].end());
    end = walked.states.back();
  }
  found.final = in_rows(equations, all.back());
  for (const double t : times)
    found.samples.push_back(t < outcome.t ? in_rows(equations, all[found.samples.size()]) : found.final);
  if (asked.whole_start) found.structure = structure_of(equations, start.state(), end, found.final);

  if (!found.events.empty())
    add_reason("times of events have derivatives along the motion alone: \"of\": \"motion\"", found);

  found.uncertainty = 0;
  add_doubt(doubt_by_runs(Neighbours(request, asked, start), equations, all.back(), keep_going), found);
  return found;
}

}  // namespace least::variations
