#include <algorithm>
#include <cmath>

#include "core/catalogue/catalogue.hpp"
#include "core/text/scene.hpp"
#include "core/variations/rows.hpp"
#include "core/variations/scheme_map.hpp"
#include "core/variations/start.hpp"

namespace least::variations {
namespace {

/// A row sink that wants none.
class Nowhere final : public RowSink {
 public:
  bool append(std::span<const double>) override { return true; }
};

/// Differences of the scheme's runs, of the fourth order, for the final state: what dual numbers are held against.
class Differences {
 public:
  Differences(const Request& request, const SensitivitiesAsked& asked, const Start& start)
      : request_(request), asked_(asked), start_(start) {
    request_.record = {Record::Mode::every, 0, {}};
    request_.columns = {0};
    request_.diagnostics.clear();
    request_.events.clear();
    request_.watched = {};
    request_.control = false;
    request_.probe = true;
  }

  /// By component; not a number where a run does not come to its end.
  std::vector<double> by(const Quantity& quantity) const {
    const double length = 1e-4 * std::max(0.1, std::abs(start_.value(quantity)));
    const auto far_up = moved(quantity, 2 * length), up = moved(quantity, length), down = moved(quantity, -length),
               far_down = moved(quantity, -2 * length);
    std::vector<double> slopes(up.size());
    for (std::size_t i = 0; i < slopes.size(); ++i)
      slopes[i] = (8 * (up[i] - down[i]) - (far_up[i] - far_down[i])) / (12 * length);
    return slopes;
  }

 private:
  std::vector<double> moved(const Quantity& quantity, double by) const {
    Request request = request_;
    auto scene = std::make_shared<Scene>(*request.scene);
    start_.move(quantity, by, *scene);
    request.scene = scene;
    Nowhere nowhere;
    const std::atomic<bool> never{false};
    const Solution ended = scene->mechanics->run(request, nowhere, never);
    std::vector<double> state;
    for (const std::size_t place : asked_.equations->variables)
      state.push_back(ended.stop.reason == ReturnCode::completed ? ended.final[place] : unknown);
    return state;
  }

  Request request_;
  const SensitivitiesAsked& asked_;
  const Start& start_;
};

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
  if (outcome.stop.reason != ReturnCode::completed || !outcome.event.empty()) {
    found.reason = "the run ended before its end, between or at a step that may be another for its neighbours";
    return found;
  }
  const Grid grid(request, request.setting("step", scheme));
  std::vector<std::int64_t> looks;
  for (const double t : times)
    if (t < outcome.t) looks.push_back(grid.step_before(t));
  found.held.add((looks.size() + 2) * size * count * sizeof(double));

  std::vector<Slopes> all(looks.size() + 1);
  std::vector<double> end;
  for (const Quantity& by : asked.by) {
    const std::vector<double> slope = start.slope(by);
    const auto moved = by.kind == Quantity::Kind::parameter ? std::optional(by.index) : std::nullopt;
    const Walk on{request, scheme, grid, start.state(), slope, looks, keep_going};
    const Walked walked = walk(on, *equations.form, equations.parameters, moved);
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

  const Differences differences(request, asked, start);
  Slopes others;
  for (const Quantity& by : asked.by) {
    if (!keep_going()) return found;
    const auto slopes = differences.by(by);
    others.insert(others.end(), slopes.begin(), slopes.end());
  }
  found.uncertainty = disagreement({in_rows(equations, all.back())}, {in_rows(equations, others)});
  return found;
}

}  // namespace least::variations
