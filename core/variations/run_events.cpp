#include "core/variations/run_events.hpp"

#include <algorithm>
#include <string_view>
#include <variant>

#include "core/catalogue/catalogue.hpp"
#include "core/run/acts.hpp"
#include "core/variations/neighbours.hpp"
#include "core/variations/sensitivities.hpp"

namespace least::variations {
namespace {

std::optional<std::string> text_of(const Report& event, std::string_view key) {
  for (const Report& part : std::get<std::vector<Report>>(event.value))
    if (part.key == key) return std::get<std::string>(part.value);
  return std::nullopt;
}

}  // namespace

std::string name_of_event(const Report& event) {
  const auto name = text_of(event, "name");
  return name ? *name : text_of(event, "kind").value_or("");
}

bool events_read_action(const Request& request) {
  const auto& variables = request.scene->card().variables;
  const auto s = std::ranges::find(variables, "s", &VariableCard::name);
  const auto reads = [&](const Measures& measures) {
    return measures.reads_energy() || measures.reads_variable(static_cast<std::size_t>(s - variables.begin()));
  };
  const auto sets_by_it = [&](const EventAsked& event) { return event.act && reads(event.act->values); };
  return s != variables.end() && (reads(request.watched) || std::ranges::any_of(request.events, sets_by_it));
}

std::vector<RunEvent> events_of(const Request& request, const Solution& outcome) {
  std::vector<RunEvent> events;
  for (const Report& report : outcome.events) {
    RunEvent& event = events.emplace_back();
    event.name = name_of_event(report);
    for (const Report& part : std::get<std::vector<Report>>(report.value))
      if (part.key == "t") event.t = std::get<double>(part.value);
    if (text_of(report, "name")) {
      const auto& list = request.watched.list;
      const auto known = std::ranges::find(list, event.name, [](const Measure& one) { return one.card.name; });
      if (known != list.end()) event.asked = static_cast<std::size_t>(known - list.begin());
    }
    event.t = std::min(event.t, outcome.t);
  }
  if (!events.empty() && !outcome.event.empty()) events.back().ends_run = events.back().name == outcome.event;
  return events;
}

std::optional<std::string> move_to_motion(const Request& request, const Solution& outcome,
                                          std::vector<RunEvent>& events, double& end, const KeepGoing& keep_going) {
  const auto asked = [](const RunEvent& event) { return event.asked.has_value(); };
  if (schemes()[request.scheme].id == "taylor" || std::ranges::none_of(events, asked)) return std::nullopt;
  const Solution motion = run_of_motion(request, outcome, keep_going);
  if (!keep_going()) return no_time;
  const std::vector<RunEvent> others = events_of(request, motion);
  const auto other = [&](auto from) { return std::find_if(from, others.end(), asked); };
  auto next = other(others.begin());
  bool same = motion.event == outcome.event;
  for (RunEvent& event : events) {
    if (!event.asked) continue;
    same = same && next != others.end() && next->name == event.name;
    if (!same) break;
    event.t = next->t;
    next = other(next + 1);
  }
  if (!same || next != others.end())
    return "the run is so far from the motion that other events happen to it, or in another order: of the motion there "
           "are no derivatives at its end";
  if (!outcome.event.empty()) end = motion.t;
  return std::nullopt;
}

}  // namespace least::variations
