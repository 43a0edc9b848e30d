#include "server/decode/ensemble_block.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace least::server {
namespace {

const std::string& column_name(const EnsemblePlan& plan, std::size_t k) {
  return plan.request.column(plan.request.columns[k]).name;
}

bool read_back(const Json& json, std::span<double> values, std::size_t first, std::size_t stride) {
  if (!json.is_array() || values.size() != json.size() * stride) return false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    if (!json[i].is_number() && !json[i].is_null()) return false;
    values[first + i * stride] = json[i].is_null() ? std::nan("") : json[i].get<double>();
  }
  return true;
}
bool read_table(const Json& json, const EnsemblePlan& plan, std::size_t rows, std::vector<double>& values) {
  const std::size_t columns = plan.request.columns.size();
  values.resize(rows * columns);
  for (std::size_t k = 0; k < columns; ++k) {
    const auto found = json.find(column_name(plan, k));
    if (found == json.end() || !read_back(*found, values, k, columns)) return false;
  }
  return true;
}

// Each member has a list of rows; all columns have the same number of them.
bool read_trajectories(const Json& json, const EnsemblePlan& plan, Trajectories& all) {
  all.member = json.at("member").get<std::vector<std::int64_t>>();
  const std::size_t columns = plan.request.columns.size();
  for (std::size_t m = 0; m < all.member.size(); ++m) {
    const std::size_t rows = json.at(column_name(plan, 0)).at(m).size(), before = all.values.size();
    all.rows.push_back(static_cast<std::int64_t>(rows));
    all.values.resize(before + rows * columns);
    const std::span<double> own = std::span(all.values).subspan(before);
    for (std::size_t k = 0; k < columns; ++k)
      if (!read_back(json.at(column_name(plan, k)).at(m), own, k, columns)) return false;
  }
  return std::ranges::all_of(json, [&](const Json& list) { return list.size() == all.member.size(); });
}

}  // namespace

std::optional<Block> read_ensemble_block(const EnsemblePlan& plan, const Json& line) try {
  Block block;
  Harvest& harvest = block.harvest;
  if (line.at("kind") != "block") return std::nullopt;
  block.index = line.at("block").get<std::int64_t>();
  block.first = line.at("first").get<std::int64_t>();
  block.count = line.at("members").get<std::int64_t>();
  harvest.ended[0] = line.at("completed").get<std::int64_t>();
  const Json& stopped = line.at("stopped");
  std::size_t known = 0;
  for (std::size_t i = 1; i < harvest.ended.size(); ++i) {
    const auto found = stopped.find(name(static_cast<ReturnCode>(i)));
    if (found == stopped.end()) continue;
    harvest.ended[i] = found->get<std::int64_t>();
    ++known;
  }
  if (known != stopped.size()) return std::nullopt;
  for (std::size_t k = 0; plan.statistics && k < plan.request.columns.size(); ++k) {
    const Json& sums = line.at("sums").at(column_name(plan, k));
    Moments& of = harvest.columns.emplace_back();
    of.count = sums.at(0).get<std::int64_t>();
    if (of.count == 0) continue;
    const auto number = [&](std::size_t i) {  // numbers that are not finite are written as null
      return sums.at(i).is_null() ? std::numeric_limits<double>::quiet_NaN() : sums.at(i).get<double>();
    };
    of.mean = number(1);
    of.squares = number(2);
    of.minimum = sums.at(3).get<double>();
    of.maximum = sums.at(4).get<double>();
  }
  for (const HistogramAsked& asked : plan.histograms) {
    const Json& counted = line.at("histograms").at(column_name(plan, asked.column));
    Histogram& of = harvest.histograms.emplace_back();
    of.counts = counted.at("counts").get<std::vector<std::int64_t>>();
    of.below = counted.at("below").get<std::int64_t>();
    of.above = counted.at("above").get<std::int64_t>();
    if (of.counts.size() != static_cast<std::size_t>(asked.bins)) return std::nullopt;
  }
  if (plan.final) {
    const Json& final = line.at("final");
    harvest.final_member = final.at("index").get<std::vector<std::int64_t>>();
    if (!read_table(final, plan, harvest.final_member.size(), harvest.final)) return std::nullopt;
  }
  if (plan.request.section) {
    const Json& section = line.at("section");
    SectionPoints& points = harvest.section;
    points.member = section.at("member").get<std::vector<std::int64_t>>();
    points.crossing = section.at("crossing").get<std::vector<std::int64_t>>();
    points.t = section.at("t").get<std::vector<double>>();
    if (points.crossing.size() != points.member.size() || points.t.size() != points.member.size() ||
        !read_table(section, plan, points.t.size(), points.values))
      return std::nullopt;
  }
  if (plan.trajectories && !read_trajectories(line.at("trajectories"), plan, harvest.trajectories)) return std::nullopt;
  harvest.truncated = line.at("truncated").get<bool>();
  harvest.unresolved = line.at("unresolved").get<std::int64_t>();
  harvest.first_unresolved = line.at("first_unresolved").get<std::int64_t>();
  harvest.cost.steps = line.at("steps").get<std::int64_t>();
  harvest.cost.force_evaluations = line.at("force_evaluations").get<std::int64_t>();
  return block;
} catch (const Json::exception&) {
  return std::nullopt;
}

}  // namespace least::server
