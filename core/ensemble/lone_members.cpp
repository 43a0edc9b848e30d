#include "core/ensemble/lone_members.hpp"

#include <algorithm>
#include <limits>

#include "core/run/diagnostics/watch.hpp"
#include "core/run/messages.hpp"
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

namespace {

/// The rows of a run, held before they are kept.
class HeldRows final : public RowSink {
 public:
  explicit HeldRows(Held& held) : held_(held), before_(held.bytes()) {}
  ~HeldRows() override { held_.shrink_by(held_.bytes() - before_); }
  HeldRows(const HeldRows&) = delete;
  HeldRows& operator=(const HeldRows&) = delete;

  bool append(std::span<const double> rows) override {
    make_room(values, values.size() + rows.size(), held_);
    values.insert(values.end(), rows.begin(), rows.end());
    return true;
  }

  std::vector<double> values;

 private:
  Held& held_;
  const std::size_t before_;
};

/// When the i-th member passes the plane of the section, by a run of its own: the next one looks at it then. The
/// harvest says where it does so more often than limits.samples has room for, and where the search ends unresolved.
std::vector<double> crossing_times(const EnsemblePlan& plan, Request request, std::int64_t i,
                                   const std::atomic<bool>& cancelled, Harvest& harvest) {
  request.watched = plan.request.watched;
  request.events = plan.request.events;
  if (std::ranges::any_of(plan.members.vary, &Variation::parameter)) {  // they are constants of an expression
    MeasureReader reader(*request.scene);
    const Measure& of = request.watched.list[0];
    if (reader.read(of.card.name, of.text)) return {};  // with these parameters it is no number anywhere
    request.watched = reader.made();
  }
  request.record = {Record::Mode::every, 0, {}};
  request.columns = {0};
  Samples none;
  const Solution solution = request.scene->mechanics->run(request, none, cancelled);
  std::vector<double> times;
  for (const Report& event : solution.events) times.push_back(Watch::time(event));
  const auto says = [&](std::string_view code) {
    return std::ranges::find(solution.warnings, code, &Warning::code) != solution.warnings.end();
  };
  harvest.truncated = harvest.truncated || says("events_truncated");
  if (says("events_unresolved")) harvest.add_unresolved(i);
  return times;
}

/// What no run begins with, as a mass that is none.
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
  request.watched = {};
  request.events = {};
  block.held.add(2 * sizeof(double) * section_count(plan));  // the times, and those that a run is asked for
  std::vector<double> times = section_times(plan);
  std::vector<double> varied;
  Harvest& harvest = block.harvest;
  for (std::int64_t i = block.first; i < block.first + block.count && !cancelled; ++i) {
    request.scene = member_scene(plan, i);
    varied.clear();
    for (const Variation& variation : plan.members.vary)
      if (variation.parameter) varied.push_back(request.scene->parameters[variation.index]);
    if (cannot_begin(*request.scene)) {
      ++harvest.ended[static_cast<std::size_t>(ReturnCode::singular)];
      continue;
    }
    if (plan.section && plan.section->plane) times = crossing_times(plan, request, i, cancelled, harvest);
    const std::size_t crossings = times.size();
    request.record = {Record::Mode::times, 0, times};
    if (crossings == 0 || times.back() != end) request.record.times.push_back(end);
    Held held = HeldByThread::take(0);
    HeldRows rows(held);
    const Solution solution = request.scene->mechanics->run(request, rows, cancelled);
    ++harvest.ended[static_cast<std::size_t>(solution.stop.reason)];
    harvest.cost.steps += solution.cost.steps;
    harvest.cost.force_evaluations += solution.cost.force_evaluations;
    const auto append_row = [&](std::size_t k, std::vector<double>& to) {
      to.resize(to.size() + columns.size());
      columns.fill(&rows.values[k * width], request.record.times[k], varied, &to[to.size() - columns.size()]);
    };
    SectionPoints points;
    points.make_room(crossings, columns.size(), held);
    for (std::size_t k = 0; k < crossings && (k + 1) * width <= rows.values.size(); ++k) {
      points.member.push_back(i);
      points.crossing.push_back(static_cast<std::int64_t>(k));
      points.t.push_back(request.record.times[k]);
      append_row(k, points.values);
    }
    const auto most = static_cast<std::size_t>(request.limits.samples);
    harvest.truncated = harvest.truncated || harvest.section.t.size() + points.t.size() > most;
    harvest.section.append(points, most, columns.size(), block.held);
    if (solution.stop.reason != ReturnCode::completed) continue;
    make_room(harvest.final_member, harvest.final_member.size() + 1, block.held);
    make_room(harvest.final, harvest.final.size() + columns.size(), block.held);
    harvest.final_member.push_back(i);
    append_row(rows.values.size() / width - 1, harvest.final);
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
  request.diagnostics.clear();
  request.control = true;
  request.limits.steps =
      std::min(request.limits.steps, steps_of_all / few / weight_of_force(*request.scene->mechanics));
  request.limits.seconds = std::numeric_limits<double>::infinity();  // how fast a machine is changes no answer

  struct Said {
    std::string_view code;
    std::int64_t member, count;
  };
  std::vector<Said> all;
  for (std::int64_t k = 0; k < few; ++k) {
    const std::int64_t member = plan.first + (few > 1 ? k * (members - 1) / (few - 1) : 0);
    request.scene = member_scene(plan, member);
    if (cannot_begin(*request.scene)) continue;
    Samples none;
    for (const Warning& warning : request.scene->mechanics->run(request, none, cancelled).warnings) {
      const auto known = std::ranges::find(all, warning.code, &Said::code);
      if (known != all.end())
        ++known->count;
      else
        all.push_back({warning.code, member, 1});
    }
  }
  std::vector<Warning> warnings;
  warnings.reserve(all.size());
  for (const auto& [code, member, count] : all)  // the page shows the words alone
    warnings.push_back({code, std::string(code) + ": " + messages::of_few(few, count, member)});
  return warnings;
}

}  // namespace least
