#include "core/ensemble/lone_members.hpp"

#include <cmath>

#include "core/run/save_schedule.hpp"
#include "core/text/scene.hpp"

namespace least {

std::shared_ptr<const Scene> member_scene(const EnsemblePlan& plan, std::int64_t i) {
  auto scene = std::make_shared<Scene>(*plan.request.scene);
  const auto values = plan.members.of(i);
  for (std::size_t k = 0; k < values.size(); ++k) {
    const Variation& varied = plan.members.vary[k];
    (varied.parameter ? scene->parameters : scene->initial)[varied.index] = values[k];
  }
  return scene;
}

void run_lone_members(const EnsemblePlan& plan, Block& block, const std::atomic<bool>& cancelled) {
  Request request = plan.request;
  const SchemeCard& scheme = request.scene->mechanics->schemes()[request.scheme];
  const double end = Grid(request, request.settings[*scheme.find("step")]).end;
  request.record = {Record::Mode::times, 0, section_times(plan)};
  const std::size_t crossings = request.record.times.size(), columns = request.columns.size();
  if (crossings == 0 || request.record.times.back() != end) request.record.times.push_back(end);
  request.diagnostics.clear();
  request.control = false;
  Harvest& harvest = block.harvest;
  for (std::int64_t i = block.first; i < block.first + block.count && !cancelled; ++i) {
    request.scene = member_scene(plan, i);
    if (const auto* text = request.scene->mechanics->text(); text && text->objection(request.scene->parameters)) {
      ++harvest.ended[static_cast<std::size_t>(ReturnCode::singular)];  // no run begins with a mass that is none
      continue;
    }
    Samples rows;
    const Solution solution = request.scene->mechanics->run(request, rows, cancelled);
    ++harvest.ended[static_cast<std::size_t>(solution.stop.reason)];
    harvest.cost.steps += solution.cost.steps;
    harvest.cost.force_evaluations += solution.cost.force_evaluations;
    SectionPoints points;
    for (std::size_t k = 0; k < crossings && (k + 1) * columns <= rows.values.size(); ++k) {
      points.member.push_back(i);
      points.crossing.push_back(static_cast<std::int64_t>(k));
      points.t.push_back(request.record.times[k]);
    }
    points.values.assign(rows.values.begin(),
                         rows.values.begin() + static_cast<std::ptrdiff_t>(points.t.size() * columns));
    const auto most = static_cast<std::size_t>(request.limits.samples);
    harvest.truncated = harvest.truncated || harvest.section.t.size() + points.t.size() > most;
    harvest.section.append(points, most, columns);
    if (solution.stop.reason != ReturnCode::completed) continue;
    harvest.final_member.push_back(i);
    harvest.final.insert(harvest.final.end(), rows.values.end() - static_cast<std::ptrdiff_t>(columns),
                         rows.values.end());
  }
}

}  // namespace least
