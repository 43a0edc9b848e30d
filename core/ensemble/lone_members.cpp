#include "core/ensemble/lone_members.hpp"

#include <algorithm>
#include <limits>

#include "core/ensemble/member_starts.hpp"
#include "core/run/diagnostics/watch.hpp"
#include "core/run/messages.hpp"
#include "core/run/save_schedule.hpp"
#include "core/text/scene.hpp"

namespace least {

namespace {

/// HeldRows collects the rows of a run and of its section, and charges their memory first.
class HeldRows final : public RowSink {
 public:
  explicit HeldRows(Held& held) : held_(held), before_(held.bytes()) {}
  ~HeldRows() override { held_.shrink_by(held_.bytes() - before_); }
  HeldRows(const HeldRows&) = delete;
  HeldRows& operator=(const HeldRows&) = delete;

  bool append(std::span<const double> rows) override { return keep(rows, values); }
  bool append_section(std::span<const double> rows) override { return keep(rows, points); }

  std::vector<double> values, points;

 private:
  bool keep(std::span<const double> rows, std::vector<double>& list) {
    make_room(list, list.size() + rows.size(), held_);
    list.insert(list.end(), rows.begin(), rows.end());
    return true;
  }

  Held& held_;
  const std::size_t before_;
};

/// set_plane puts the section's plane into a member's request, with the member's values of varied parameters as
/// constants of the expression. If the expression is not finite anywhere for these, the request gets no plane.
void set_plane(const EnsemblePlan& plan, Request& request) {
  request.section = plan.request.section;
  request.watched = plan.request.watched;
  request.events = plan.request.events;
  if (std::ranges::none_of(plan.members.vary, &Variation::is_parameter)) return;
  MeasureReader reader(*request.scene);
  const Measure& of = plan.request.watched.list[0];
  const bool read = !reader.read(of.card.name, of.text);
  request.watched = reader.made();
  if (read) return;
  request.section.reset();
  request.events.clear();
}

/// cannot_begin: no run can begin with these parameters, such as a mass that is not positive.
bool cannot_begin(const Scene& scene) {
  const auto* text = scene.mechanics->text();
  return text && text->objection(scene.parameters);
}

}  // namespace

void run_lone_members(const EnsemblePlan& plan, const MemberColumns& columns, Block& block,
                      const std::atomic<bool>& cancelled) {
  Request request = plan.request;
  request.columns = columns.needed();
  request.measures = {};
  const SchemeCard& scheme = request.scene->mechanics->schemes()[request.scheme];
  const double end = Grid(request, request.settings[*scheme.find("step")]).end;
  const std::size_t width = columns.needed().size();
  request.diagnostics.clear();
  request.control = false;
  const bool plane = request.section && request.section->plane;
  block.held.add(3 * sizeof(double) * (section_count(plan) + row_count(plan)));  // looks and their times
  const std::vector<Look> looks = looks_of(plan);
  request.record = {Record::Mode::times, 0, {}};
  for (const Look& look : looks) request.record.times.push_back(look.t);
  if (looks.empty() || looks.back().t != end) request.record.times.push_back(end);
  if (!plane) request.section.reset();  // its times are among the looks
  const MemberStarts starts(plan);
  std::vector<double> varied;
  Harvest& harvest = block.harvest;
  Trajectories& ways = harvest.trajectories;
  const auto most = static_cast<std::size_t>(plan.request.most_points());
  for (std::int64_t i = block.first; i < block.first + block.count && !cancelled; ++i) {
    request.scene = starts.scene(i);
    varied.clear();
    for (const Variation& variation : plan.members.vary)
      if (variation.is_parameter()) varied.push_back(request.scene->parameters[variation.index]);
    if (plan.trajectories) {
      make_room(ways.member, ways.member.size() + 1, block.held);
      make_room(ways.rows, ways.rows.size() + 1, block.held);
      ways.member.push_back(i);
      ways.rows.push_back(0);
    }
    if (cannot_begin(*request.scene)) {
      ++harvest.ended[static_cast<std::size_t>(ReturnCode::singular)];
      continue;
    }
    if (plane) set_plane(plan, request);
    Held held = HeldByThread::take(0);
    HeldRows rows(held);
    const Solution solution = request.scene->mechanics->run(request, rows, cancelled);
    const auto says = [&](std::string_view code) {
      return std::ranges::find(solution.warnings, code, &Warning::code) != solution.warnings.end();
    };
    ++harvest.ended[static_cast<std::size_t>(solution.stop.reason)];
    harvest.cost.steps += solution.cost.steps;
    harvest.cost.force_evaluations += solution.cost.force_evaluations;
    harvest.truncated = harvest.truncated || says("section_truncated");
    if (says("events_unresolved")) harvest.add_unresolved(i);
    const auto append_row = [&](const double* row, double t, std::vector<double>& to, Held& room) {
      make_room(to, to.size() + columns.size(), room);
      to.resize(to.size() + columns.size());
      columns.fill(row, t, varied, &to[to.size() - columns.size()]);
    };
    SectionPoints points;
    const auto add_point = [&](const double* row, double t) {
      points.make_room(points.t.size() + 1, columns.size(), held);
      points.member.push_back(i);
      points.crossing.push_back(static_cast<std::int64_t>(points.crossing.size()));
      points.t.push_back(t);
      append_row(row, t, points.values, held);
    };
    const std::size_t known = rows.values.size() / width;
    for (std::size_t k = 0; k < std::min(known, looks.size()); ++k) {
      const double* row = &rows.values[k * width];
      if (!looks[k].row) {
        add_point(row, looks[k].t);
        continue;
      }
      append_row(row, looks[k].t, ways.values, block.held);
      ++ways.rows.back();
    }
    const std::size_t apart = request.section_columns().size();
    std::vector<double> needed(width);
    for (std::size_t at = 0; at < rows.points.size(); at += apart) {
      const double* point = &rows.points[at];  // the time, then the other columns
      for (std::size_t k = 0, next = 1; k < width; ++k) needed[k] = point[request.columns[k] == 0 ? 0 : next++];
      add_point(needed.data(), point[0]);
    }
    harvest.truncated = harvest.truncated || harvest.section.t.size() + points.t.size() > most;
    harvest.section.append(points, most, columns.size(), block.held);
    if (solution.stop.reason != ReturnCode::completed) continue;
    make_room(harvest.final_member, harvest.final_member.size() + 1, block.held);
    harvest.final_member.push_back(i);
    append_row(&rows.values[(known - 1) * width], end, harvest.final, block.held);
  }
}

std::vector<Warning> warnings_of_few(const EnsemblePlan& plan, const std::atomic<bool>& cancelled) {
  constexpr std::int64_t most = 8, steps_of_all = 400'000;
  const std::int64_t members = plan.last - plan.first, few = std::min(members, most);
  Request request = plan.request;
  request.record = {Record::Mode::every, 0, {}};
  request.columns = {0};
  request.measures = {};
  request.watched = {};
  request.events = {};
  request.section.reset();
  request.diagnostics.clear();
  request.control = true;
  request.limits.steps =
      std::min(request.limits.steps, steps_of_all / few / weight_of_force(*request.scene->mechanics));
  // The result must not depend on the speed of the machine
  request.limits.seconds = std::numeric_limits<double>::infinity();

  struct WarningCount {
    std::string_view code;
    std::int64_t member, count;
  };
  const MemberStarts starts(plan);
  std::vector<WarningCount> all;
  for (std::int64_t k = 0; k < few; ++k) {
    const std::int64_t member = plan.first + (few > 1 ? k * (members - 1) / (few - 1) : 0);
    request.scene = starts.scene(member);
    if (cannot_begin(*request.scene)) continue;
    Samples none;
    for (const Warning& warning : request.scene->mechanics->run(request, none, cancelled).warnings) {
      const auto known = std::ranges::find(all, warning.code, &WarningCount::code);
      if (known != all.end())
        ++known->count;
      else
        all.push_back({warning.code, member, 1});
    }
  }
  std::vector<Warning> warnings;
  warnings.reserve(all.size());
  for (const auto& [code, member, count] : all)  // a page shows these words only
    warnings.push_back({code, std::string(code) + ": " + messages::of_few(few, count, member)});
  return warnings;
}

}  // namespace least
