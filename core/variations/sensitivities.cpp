#include "core/variations/sensitivities.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/run/messages.hpp"
#include "core/variations/event_slopes.hpp"
#include "core/variations/rows.hpp"
#include "core/variations/start.hpp"
#include "core/variations/varied_motion.hpp"

namespace least::variations {
namespace {

/// The motion with some of its directions, at all times that were asked for and at last at the end.
struct Followed {
  std::vector<std::vector<double>> states, slopes;  ///< slopes: direction by direction
  int order = 0;
};

struct Question {
  const SensitivitiesAsked& asked;
  double began, end;
  std::vector<double> times;  ///< that do not decrease
  const KeepGoing& keep_going;
  Start start;
  std::vector<Direction> directions;
  std::vector<std::vector<double>> slopes;
};

/// Directions from `first` on, or why they were not followed to the end.
std::variant<Followed, std::string> follow(const Question& question, std::size_t first, std::size_t count,
                                           double tolerance, int order) {
  Followed made;
  Derivatives beginning;
  for (std::size_t d = first; d < first + count; ++d)
    beginning.first.insert(beginning.first.end(), question.slopes[d].begin(), question.slopes[d].end());
  VariedMotion motion(*question.asked.equations, std::span(question.directions).subspan(first, count), {}, tolerance,
                      order);
  made.order = motion.order();
  motion.start(question.start.state(), beginning, question.began);
  const auto ends = [&] {
    const double t = question.asked.equations->backward ? 0 - motion.time() : motion.time();
    return "the motion and its derivatives cannot be followed beyond t = " + messages::number(t);
  };
  const auto look = [&](double t) {
    const bool seen = motion.look(t);
    if (!seen) return false;
    made.states.emplace_back(motion.state().begin(), motion.state().end());
    made.slopes.push_back(motion.derivatives().first);
    return true;
  };
  for (std::size_t next = 0;;) {
    for (; next < question.times.size() && question.times[next] <= std::max(motion.reach(), motion.time()); ++next)
      if (!look(question.times[next])) return ends();
    if (!(motion.time() < question.end)) break;
    if (!question.keep_going()) return "the time that the request has was over before they were found";
    if (!motion.advance(question.end)) return ends();
  }
  if (!look(question.end)) return ends();
  return made;
}

/// All of them, in as few parts as are short enough.
std::variant<Followed, std::string> follow_all(const Question& question, double tolerance, int order) {
  Followed all;
  for (std::size_t first = 0, count = question.directions.size(); first < question.directions.size();) {
    count = std::min(count, question.directions.size() - first);
    try {
      auto part = follow(question, first, count, tolerance, order);
      if (auto* why = std::get_if<std::string>(&part)) return std::move(*why);
      auto& made = std::get<Followed>(part);
      all.order = made.order;
      all.states = std::move(made.states);
      all.slopes.resize(made.slopes.size());
      for (std::size_t i = 0; i < made.slopes.size(); ++i)
        all.slopes[i].insert(all.slopes[i].end(), made.slopes[i].begin(), made.slopes[i].end());
      first += count;
    } catch (const tape::TooManyOperations&) {
      if (count == 1) return "the equations of their derivatives are too long";
      count = (count + 1) / 2;
    }
  }
  return all;
}

/// An event of a run.
struct Event {
  std::string name;
  double t = 0;
  std::optional<std::size_t> asked{};  ///< which of those that were asked for; none: one of the scheme's own
  bool ends = false;                   ///< the run
};

std::optional<std::string> text_of(const Report& event, std::string_view key) {
  for (const Report& part : std::get<std::vector<Report>>(event.value))
    if (part.key == key) return std::get<std::string>(part.value);
  return std::nullopt;
}

std::vector<Event> events_of(const Request& request, const Solution& outcome) {
  std::vector<Event> events;
  for (const Report& report : outcome.events) {
    Event& event = events.emplace_back();
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
  if (!events.empty() && !outcome.event.empty()) events.back().ends = events.back().name == outcome.event;
  return events;
}

}  // namespace

std::string name_of_event(const Report& event) {
  const auto name = text_of(event, "name");
  return name ? *name : text_of(event, "kind").value_or("");
}

std::vector<bool> varied_parameters(const SensitivitiesAsked& asked, std::size_t parameters) {
  std::vector<bool> varied(parameters, false);
  for (const Quantity& by : asked.by)
    if (by.kind == Quantity::Kind::parameter) varied[by.index] = true;
  return varied;
}

Sensitivities sensitivities_of_motion(const Request& request, const SensitivitiesAsked& asked, const Solution& outcome,
                                      std::span<const double> times, double tolerance, const KeepGoing& keep_going) {
  const ParametricScene& equations = *asked.equations;
  const Scene& scene = *request.scene;
  std::vector<Event> events = events_of(request, outcome);
  Question question{asked,      scene.start,         outcome.t, {times.begin(), times.end()},
                    keep_going, Start(scene, asked), {},        {}};
  for (const Event& event : events)
    if (event.asked) question.times.push_back(event.t);
  std::ranges::sort(question.times);
  for (const Quantity& by : asked.by) {
    question.directions.push_back(by.kind == Quantity::Kind::parameter ? Direction(by.index) : Direction());
    question.slopes.push_back(question.start.slope(by));
  }
  Sensitivities found;
  for (const std::size_t place : equations.variables) found.rows.push_back(scene.card().variables[place].name);
  const std::size_t numbers = (question.times.size() + 1) * question.directions.size() * equations.components;
  found.held.add(2 * numbers * sizeof(double));
  auto followed = follow_all(question, tolerance, 0);
  if (auto* why = std::get_if<std::string>(&followed)) {
    found.reason = std::move(*why);
    return found;
  }
  auto& all = std::get<Followed>(followed);
  const auto at = [&](double t) {
    return static_cast<std::size_t>(std::ranges::lower_bound(question.times, t) - question.times.begin());
  };
  constexpr int higher = 3;
  const auto control = follow_all(question, tolerance / 2, std::min(all.order + higher, tape::Series::most_orders));
  if (const auto* other = std::get_if<Followed>(&control)) found.uncertainty = disagreement(all.slopes, other->slopes);

  if (!events.empty()) {
    const EventSlopes slopes(scene, asked.equations, request.watched);
    const std::size_t size = equations.components;
    for (const Event& event : events) {
      auto& told = found.events.emplace_back(event.name, std::vector<double>(asked.by.size(), unknown));
      if (!event.asked) continue;
      const std::size_t place = at(event.t);
      for (std::size_t d = 0; d < asked.by.size(); ++d)
        told.second[d] = slopes(*event.asked, event.t, all.states[place],
                                std::span(all.slopes[place]).subspan(d * size, size), question.directions[d]);
      if (event.ends) {  // what the run ends with is the state at a time that changes, too
        const std::vector<double> rates = slopes.rates(event.t, all.states[place]);
        for (std::size_t d = 0; d < asked.by.size(); ++d)
          for (std::size_t i = 0; i < size; ++i) all.slopes.back()[d * size + i] += rates[i] * told.second[d];
      }
      for (double& slope : told.second) slope *= equations.sign_of_time();
    }
  }
  found.final = in_rows(equations, all.slopes.back());
  for (const double t : times) found.samples.push_back(in_rows(equations, all.slopes[at(t)]));
  if (asked.whole_start)
    found.structure = structure_of(equations, question.start.state(), all.states.back(), found.final);
  return found;
}

}  // namespace least::variations
