#include "core/variations/run_events.hpp"

#include <algorithm>
#include <string_view>
#include <variant>

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

}  // namespace least::variations
