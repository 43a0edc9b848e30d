#include "core/variations/sensitivities.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "core/run/messages.hpp"
#include "core/variations/doubt.hpp"
#include "core/variations/following.hpp"
#include "core/variations/neighbours.hpp"
#include "core/variations/random_direction.hpp"
#include "core/variations/rows.hpp"
#include "core/variations/structure.hpp"

namespace least::variations {
namespace {

/// doubt_of estimates the relative error of the first derivatives by a control in one direction, at samples and at the
/// end: the control that was followed beside them, or one that is followed now, with half the tolerance and through the
/// same events. The latter is needed where steps are not precomputed, where an event acts, and where the motion is so
/// sensitive that the first control, which holds only while it stays close to the motion, has left it and is NaN.
/// Second derivatives are controlled pair by pair, in add_second.
Doubt doubt_of(const Question& question, const Followed& all, double tolerance, int order) {
  if (all.control.size() == all.slopes.size()) {
    const double beside = disagreement_along(all.slopes, question.weights, all.control);
    if (!std::isnan(beside)) return {beside};
  }
  Held of_control = HeldByThread::take(bytes_of_lists(all.slopes.size(), all.state.size()));
  Question one = question;
  if (const std::size_t reached = all.slopes.size(); reached <= one.times.size()) {
    one.end = one.times[reached - 1];
    one.times.resize(reached - 1);
  }
  std::vector<double> starts;
  for (const auto& slope : question.slopes) starts.insert(starts.end(), slope.begin(), slope.end());
  one.directions = {sum_of(question.directions, question.weights)};
  one.slopes = {sum_of(starts, question.weights)};
  one.weights.clear();
  const Followed control = follow_all(one, tolerance, order);
  if (!control.reason.empty()) return {unknown, "of a control, " + control.reason};
  return compared(disagreement_along(all.slopes, question.weights, control.slopes));
}

/// ends_at_event tells whether an event that was asked for has ended the run.
bool ends_at_event(const Question& question) {
  return !question.events.empty() && question.events.back().ends_run && question.events.back().asked;
}

/// move_to_event turns second derivatives at a fixed end time into those at the event that has ended the run. Events
/// that act need no such change: theirs belong to the state that the event makes. `all` holds the motion and its first
/// derivatives at that fixed time.
void move_to_event(const Question& question, const Followed& all,
                   const std::vector<std::pair<std::size_t, std::size_t>>& pairs, std::vector<double>& second) {
  if (!ends_at_event(question)) return;
  const RunEvent& event = question.events.back();
  if (question.slopes_of_events.acts(*event.asked)) return;
  const std::size_t size = all.state.size();
  const auto along = [&](std::size_t d) {
    return EventSlopes::DirectedSlope{std::span(all.slopes.back()).subspan(d * size, size), question.directions[d]};
  };
  for (std::size_t pair = 0; pair < pairs.size(); ++pair) {
    const auto part = std::span(second).subspan(pair * size, size);
    std::ranges::copy(question.slopes_of_events.second_at(*event.asked, question.end, all.state,
                                                          along(pairs[pair].first), along(pairs[pair].second), part),
                      part.begin());
  }
}

/// add_second adds all second derivatives, and their error estimate from a second computation with a higher order.
void add_second(const Question& question, const Followed& all, double tolerance, Sensitivities& found) {
  const ParametricScene& equations = *question.asked.equations;
  for (std::size_t a = 0; a < question.directions.size(); ++a)
    for (std::size_t b = a; b < question.directions.size(); ++b) found.pairs.emplace_back(a, b);
  Question of_end = question;
  of_end.times.clear();
  auto second = follow_pairs(of_end, found.pairs, tolerance, 0);
  if (auto* why = std::get_if<std::string>(&second)) return add_reason(*why, found);
  move_to_event(question, all, found.pairs, std::get<std::vector<double>>(second));
  found.second = in_rows(equations, std::get<std::vector<double>>(second));
  auto other = follow_pairs(of_end, found.pairs, tolerance / 2, order_of_control(all.order));
  if (auto* why = std::get_if<std::string>(&other)) return add_doubt({unknown, "of a control, " + *why}, found);
  auto& known = std::get<std::vector<double>>(other);
  move_to_event(question, all, found.pairs, known);
  add_doubt(compared(disagreement({found.second}, {in_rows(equations, known)})), found);
}

/// Where the equations are singular at the start, leave_singular_start lets the question begin a little later, or sets
/// the reason why it cannot. It removes the times that equal the start from the question's times, and returns the
/// slopes for each of these.
std::vector<std::vector<double>> leave_singular_start(const Request& request, const Solution& outcome,
                                                      Question& question, std::string& reason) {
  constexpr double part = 1.0 / 64;
  const std::vector<double> rates = question.slopes_of_events.rates(question.began, question.state);
  if (std::ranges::all_of(rates, [](double rate) { return std::isfinite(rate); })) return {};
  const auto first = std::ranges::find_if(question.times, [&](double t) { return t > question.began; });
  std::vector<double> slopes;
  for (const auto& slope : question.slopes) slopes.insert(slopes.end(), slope.begin(), slope.end());
  std::vector<std::vector<double>> at_start(static_cast<std::size_t>(first - question.times.begin()), slopes);
  double t = question.began + part * (question.end - question.began);
  if (first != question.times.end()) t = std::min(t, *first);
  for (const RunEvent& event : question.events)
    if (event.t > question.began) t = std::min(t, std::midpoint(question.began, event.t));
  question.times.erase(question.times.begin(), first);
  auto later = beyond_singular_start(request, outcome, question.asked, question.start, t, question.keep_going);
  if (auto* why = std::get_if<std::string>(&later)) {
    reason = std::move(*why);
  } else {
    auto& known = std::get<Beginning>(later);
    question.began = known.t;
    question.state = std::move(known.state);
    question.slopes = std::move(known.slopes);
  }
  return at_start;
}

/// Where an event has ended the run, the final state is taken at the event's time, which changes as well:
/// move_to_event turns first derivatives at a fixed end time into those at the event.
void move_to_event(const Question& question, Followed& all) {
  if (!ends_at_event(question)) return;
  const std::vector<double> rates = question.slopes_of_events.rates(question.events.back().t, all.state);
  const std::vector<double>& later = all.time_slopes.back();
  for (std::size_t d = 0; d < later.size(); ++d)
    for (std::size_t i = 0; i < rates.size(); ++i) all.slopes.back()[d * rates.size() + i] += rates[i] * later[d];
}

/// volume_at_event returns what remains of volumes where the end is moved along the motion to the event that has ended
/// the run: det(1 + f ∂t/∂x) = 1 + f·∂t/∂x, f being the rates. This is 0 where the event depends on the state alone.
double volume_at_event(const Question& question, const std::vector<double>& end) {
  constexpr double rounding = 64 * std::numeric_limits<double>::epsilon();
  if (!ends_at_event(question) || question.slopes_of_events.acts(*question.events.back().asked)) return 1;
  const RunEvent& event = question.events.back();
  const std::vector<double> rates = question.slopes_of_events.rates(event.t, end);
  std::vector<double> along(end.size());
  double volume = 1, terms = 1;
  for (std::size_t i = 0; i < end.size(); ++i) {
    along[i] = 1;
    const double term = rates[i] * question.slopes_of_events.time_slope(*event.asked, event.t, end, along, {});
    along[i] = 0;
    volume += term;
    terms += std::abs(term);
  }
  return std::abs(volume) <= rounding * terms ? 0 : volume;
}

/// reason_without_slope says why the time of an event has no derivative.
std::string reason_without_slope(const RunEvent& event) {
  if (!event.asked) return "the times of events that were not asked for have no derivatives";
  return "the time of " + event.name + " has no derivative, as its expression does not change in time there";
}

/// add_events adds the derivatives of the times of events, of those that were reached.
void add_events(const Question& question, const Followed& all, Sensitivities& found) {
  auto reached = all.time_slopes.begin();
  for (const RunEvent& event : question.events) {
    auto& told = found.events.emplace_back(event.name, std::vector<double>(question.asked.by.size(), unknown)).second;
    if (event.asked && reached == all.time_slopes.end()) continue;  // there is a reason why it was not reached
    if (event.asked) told = *reached++;
    for (double& slope : told) slope *= question.asked.equations->sign_of_time();
    if (std::ranges::all_of(told, [](double slope) { return std::isfinite(slope); })) continue;
    if (const std::string why = reason_without_slope(event); found.reason.find(why) == std::string::npos)
      add_reason(why, found);
  }
}

/// map_of_part returns the map of the motion between two times, through the events in between. An event that acts and
/// ends the run belongs to the last part, with its time; one that only ends it is left to volume_at_event.
std::optional<TangentMap> map_of_part(const Question& whole, double from, double to, const std::vector<double>& start,
                                      double tolerance) {
  std::vector<RunEvent> events;
  for (const RunEvent& event : whole.events)
    if ((event.t > from || from == whole.began) && (event.t <= to || to == whole.end)) events.push_back(event);
  const Question part{
      whole.asked,      from,        to, {}, whole.keep_going, whole.start, start, events, whole.slopes_of_events,
      whole.directions, whole.slopes};
  Followed all = follow_all(part, tolerance, 0);
  if (!all.reason.empty()) return std::nullopt;
  if (ends_at_event(part) && part.slopes_of_events.acts(*events.back().asked)) move_to_event(part, all);
  return tangent_map(*whole.asked.equations, start, all.state, all.slopes.back());
}

}  // namespace

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
  std::vector<RunEvent> events = events_of(request, outcome);
  double end = outcome.t;
  const std::optional<std::string> elsewhere = move_to_motion(request, outcome, events, end, keep_going);
  const EventSlopes slopes_of_events(request, asked.equations);
  Question question{asked,  scene.start,     end, {times.begin(), times.end()}, keep_going, Start(scene, asked), {},
                    events, slopes_of_events};
  question.state = question.start.state();
  for (const Quantity& by : asked.by) {
    question.directions.push_back(by.kind == Quantity::Kind::parameter ? Direction{{by.index, 1}} : Direction());
    question.slopes.push_back(question.start.slope(by));
  }
  question.weights = random_weights(asked.by.size());
  Sensitivities found;
  for (const std::size_t place : equations.variables) found.rows.push_back(scene.card().variables[place].name);
  const std::size_t bytes = bytes_of_lists(times.size() + 1, asked.by.size() * equations.components);
  found.held.add(bytes);
  if (std::ranges::find(outcome.warnings, "events_truncated", &Warning::code) != outcome.warnings.end()) {
    found.reason = "there were more events than limits.samples has room for";
    return found;
  }
  if (elsewhere) {
    found.reason = *elsewhere;
    return found;
  }
  if (!times.empty() && times.back() > end) {
    found.reason = "the motion comes to where the run ends before a sample of the run";
    return found;
  }
  const auto at_start = leave_singular_start(request, outcome, question, found.reason);
  if (!found.reason.empty()) return found;
  Followed all = follow_all(question, tolerance, 0);
  found.reason = all.reason;
  if (!all.slopes.empty()) {
    found.uncertainty = 0;
    add_doubt(doubt_of(question, all, tolerance / 2, order_of_control(all.order)), found);
  }
  const bool whole = all.reason.empty();
  if (whole && asked.order == 2) add_second(question, all, tolerance, found);
  add_events(question, all, found);
  if (whole) move_to_event(question, all);
  for (const auto& slopes : at_start) found.samples.push_back(in_rows(equations, slopes));
  const std::vector<double> at_end = whole ? all.slopes.back() : std::vector<double>();
  for (auto& slopes : all.slopes) {
    found.samples.push_back(in_rows(equations, slopes));
    slopes = {};
  }
  if (!whole) return found;
  found.final = std::move(found.samples.back());
  found.samples.pop_back();
  if (switches(equations)) {  // derivatives across jumps of the rates are checked by differences of runs
    const Neighbours neighbours(closely(request, outcome), asked, question.start);
    add_doubt(doubt_by_runs(neighbours, equations, at_end, keep_going), found);
  }
  if (asked.whole_start) {
    const auto map_of = [&](double from, double to, const std::vector<double>& start) {
      return map_of_part(question, from, to, start, tolerance);
    };
    add_structure(equations, tangent_map(equations, question.state, all.state, at_end),
                  {question.began, question.end, false, map_of, volume_at_event(question, all.state)}, found);
  }
  return found;
}

}  // namespace least::variations
