// Plans of ensembles for tests.
#pragma once

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "core/catalogue/catalogue.hpp"
#include "core/ensemble/ensemble.hpp"
#include "core/ensemble/lane_members.hpp"
#include "core/ensemble/lone_members.hpp"
#include "tests/support/runs.hpp"

namespace test {

/// ensemble_of() plans runs of a problem by a scheme up to the time `end`, with defaults otherwise and no members yet.
/// It skips the test where the problem is left out of this build.
inline least::EnsemblePlan ensemble_of(std::string_view problem, std::string_view scheme, double end) {
  runs::problem_called(problem);
  least::EnsemblePlan plan;
  plan.request = least::default_request(problem, scheme);
  plan.request.end = end;
  plan.request.limits.seconds = 1e9;  // so that results do not depend on how fast the machine is
  plan.request.diagnostics.clear();
  return plan;
}
inline void set_members(least::EnsemblePlan& plan, std::int64_t count, std::vector<least::Variation> vary) {
  plan.members = {count, 7, std::move(vary)};
  plan.first = 0;
  plan.last = count;
}
/// setting() returns a setting of the plan's scheme by its name; it throws std::out_of_range where there is none.
inline double& setting(least::EnsemblePlan& plan, std::string_view name) {
  const auto at = least::schemes()[plan.request.scheme].find(name);
  if (!at) throw std::out_of_range(std::string(name));
  return plan.request.settings[*at];
}
inline void set_columns(least::EnsemblePlan& plan, std::initializer_list<std::string_view> names) {
  plan.request.columns.clear();
  const auto& columns = plan.request.scene->card().columns;
  for (const auto name : names) {
    const auto found = std::ranges::find(columns, name, &least::ColumnCard::name);
    if (found == columns.end()) throw std::out_of_range(std::string(name));
    plan.request.columns.push_back(static_cast<std::size_t>(found - columns.begin()));
  }
}
/// set_plane() asks for the section expression = 0, crossed upwards (1), downwards (−1) or both ways (0).
inline void set_plane(least::EnsemblePlan& plan, const std::string& expression, int direction) {
  least::MeasureReader reader(*plan.request.scene);
  if (const auto fault = reader.read("section", expression)) throw std::invalid_argument(fault->detail);
  plan.request.watched = reader.made();
  plan.request.events = {{direction, false}};
  plan.request.section = least::Section{true};
}
/// about_start() plans `count` members whose starts are spread about the card's own, over `steps` steps, which need not
/// be a whole number.
inline least::EnsemblePlan about_start(const std::string& problem, std::size_t scheme, std::int64_t count,
                                       double steps) {
  least::EnsemblePlan plan = ensemble_of(problem, least::schemes()[scheme].id, 1);
  auto scene = std::make_shared<least::Scene>(*plan.request.scene);
  if (problem == "lane_emden") scene->start = 2;
  std::vector<least::Variation> vary;
  for (std::size_t i = 0; i < scene->initial.size(); ++i) {
    double& x = scene->initial[i];
    if (std::isnan(x)) continue;
    const double width = 0.02 * (1 + std::abs(x));
    vary.push_back({least::Varied::variable, i, least::Spread::uniform, {x - width, x + width}});
  }
  plan.request.end = scene->start + steps * setting(plan, "step");
  plan.request.scene = std::move(scene);
  set_members(plan, count, vary);
  return plan;
}
/// compositions_of() returns the positions of some compositions of the scheme, the recommended one among them; {0}
/// where the scheme has none.
inline std::vector<double> compositions_of(const least::SchemeCard& scheme) {
  if (!scheme.find("composition")) return {0};
  return {0, 1, 4, 8};
}

/// for_each_pair() calls f(plan, name) for every pair of problem and scheme whose ensembles run in lanes.
template <class F>
void for_each_pair(F&& f) {
  for (const auto& problem : least::problem_list())
    for (const auto index : problem->card().schemes) {
      const least::SchemeCard& scheme = least::schemes()[index];
      if (!least::ensemble_objection(scheme).empty()) continue;
      if (scheme.id == "lifted_splitting") continue;  // its steps are found in the equations: members go one by one
      for (const double composition : compositions_of(scheme)) {
        least::EnsemblePlan plan = about_start(problem->card().id, index, 37, 60.4);
        if (const auto at = scheme.find("composition")) plan.request.settings[*at] = composition;
        f(plan, problem->card().id + " by " + scheme.id + ", " + std::to_string(composition));
      }
    }
}

/// in_lanes() runs the members of the plan as one block, several at a time in the lanes of `unit`; it returns nothing
/// where these members cannot run in lanes.
inline std::optional<least::Harvest> in_lanes(const least::EnsemblePlan& plan, const least::LaneUnit& unit) {
  const std::atomic<bool> never{false};
  const least::MemberColumns columns(plan.request, plan.members.vary);
  least::Block block{0, plan.first, plan.last - plan.first, {}};
  if (!least::run_lane_members(plan, columns, block, never, unit)) return std::nullopt;
  return block.harvest;
}
/// alone() runs the same members, each by a run of its own.
inline least::Harvest alone(const least::EnsemblePlan& plan) {
  const std::atomic<bool> never{false};
  least::Block block{0, plan.first, plan.last - plan.first, {}};
  least::run_lone_members(plan, {plan.request, plan.members.vary}, block, never);
  return block.harvest;
}
/// harvest_of() runs the whole plan with so many threads; it throws where the ensemble does not complete.
inline least::Harvest harvest_of(const least::EnsemblePlan& plan, unsigned threads = 1) {
  const std::atomic<bool> never{false};
  least::Harvest all;
  const auto reason = least::run_ensemble(plan, {}, threads, never, [&](const least::Block& block) {
    all.add(block.harvest, static_cast<std::size_t>(plan.request.limits.samples));
    return true;
  });
  if (reason != least::ReturnCode::completed) throw std::runtime_error(std::string(least::name(reason)));
  return all;
}

}  // namespace test
