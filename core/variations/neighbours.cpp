#include "core/variations/neighbours.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/catalogue/catalogue.hpp"
#include "core/run/acts.hpp"

namespace least::variations {
namespace {

/// Nowhere discards all rows and ends a run once keep_going() returns false.
class Nowhere final : public RowSink {
 public:
  explicit Nowhere(const KeepGoing& keep_going) : keep_going_(keep_going) {}
  bool append(std::span<const double>) override { return keep_going_(); }
  bool progress(double, std::int64_t) override { return keep_going_(); }

 private:
  const KeepGoing& keep_going_;
};

/// bare removes from a request everything that does not influence its end.
Request bare(Request request) {
  request.record = {Record::Mode::every, 0, {}};
  request.columns = {0};
  request.diagnostics.clear();
  request.control = false;
  request.probe = true;
  return request;
}

/// reread parses expressions anew with the scene's parameters, which are constants in them.
Measures reread(const Measures& measures, const Scene& scene, bool velocities) {
  MeasureReader reader(scene, velocities);
  for (const Measure& one : measures.list) reader.read(one.card.name, one.text);
  Measures made = reader.made();
  if (made.size() != measures.size()) return measures;
  for (std::size_t i = 0; i < made.size(); ++i) made.list[i].card = measures.list[i].card;
  return made;
}

/// set_parameters_of_events has the events of a request, and what they set, take the parameters of its scene.
void set_parameters_of_events(Request& request) {
  request.watched = reread(request.watched, *request.scene, false);
  for (EventAsked& event : request.events) {
    if (!event.act) continue;
    auto act = std::make_shared<Act>(*event.act);
    act->values = reread(act->values, *request.scene, true);
    event.act = std::move(act);
  }
}

/// end_of runs a bare request, which ends once keep_going() returns false.
Solution end_of(const Request& request, const KeepGoing& keep_going) {
  Nowhere nowhere(keep_going);
  const std::atomic<bool> never{false};
  return request.scene->mechanics->run(request, nowhere, never);
}

}  // namespace

Request closely(const Request& request, const Solution& outcome) {
  constexpr double close = 1e-14;
  Request made = request;
  const auto series = std::ranges::find(schemes(), "taylor", &SchemeCard::id);
  made.scheme = static_cast<std::size_t>(series - schemes().begin());
  made.settings.clear();
  for (const ParameterCard& setting : series->parameters)
    made.settings.push_back(setting.name == "tolerance" ? close : setting.value);
  made.until_steps = false;
  if (outcome.event.empty()) made.end = outcome.t;
  return made;
}

Solution run_of_motion(const Request& request, const Solution& outcome, const KeepGoing& keep_going) {
  return end_of(bare(closely(request, outcome)), keep_going);
}

Neighbours::Neighbours(const Request& request, const SensitivitiesAsked& asked, const Start& start)
    : request_(bare(request)), asked_(asked), start_(start) {
  // The end of a run tells optional variables, as s, where their columns are asked for.
  for (const std::size_t place : asked.equations->variables)
    if (request.scene->card().variables[place].optional) request_.columns.push_back(place + 1);
}

std::optional<std::vector<double>> Neighbours::differences(std::span<const double> found,
                                                           const KeepGoing& keep_going) const {
  double largest = 0;
  for (const double slope : found) largest = std::max(largest, std::abs(slope));
  std::vector<double> all;
  for (const Quantity& by : asked_.by) {
    const std::span known = found.subspan(all.size(), found.size() / asked_.by.size());
    // The start moves along with the motion, so that the derivative stays 0
    if (by.kind == Quantity::Kind::time && start_.follows_from_time()) {
      all.insert(all.end(), known.begin(), known.end());
      continue;
    }
    const auto slopes = nearest(by, known, largest, keep_going);
    if (!slopes) return std::nullopt;
    all.insert(all.end(), slopes->begin(), slopes->end());
  }
  return all;
}

/// nearest makes the change smaller as long as the differences approach `found`: close to a centre of force, a larger
/// change leads to quite another motion, and its differences say nothing of the derivative.
std::optional<std::vector<double>> Neighbours::nearest(const Quantity& by, std::span<const double> found,
                                                       double largest, const KeepGoing& keep_going) const {
  constexpr double close = 1e-9, smaller = 0.125;
  constexpr int rounds = 7;
  std::vector<double> best;
  double least = std::numeric_limits<double>::infinity();
  double length = 1e-4 * std::max(0.1, std::abs(start_.value(by)));
  for (int round = 0; round < rounds && !(least <= close * largest); ++round, length *= smaller) {
    if (!keep_going()) return std::nullopt;
    std::vector<double> slopes = difference(by, length, keep_going);
    double most = 0;
    for (std::size_t i = 0; i < slopes.size(); ++i)
      if (const double d = std::abs(slopes[i] - found[i]); !(d <= most)) most = d;
    if (!best.empty() && !std::isnan(least) && !(most < least)) break;
    best = std::move(slopes);
    least = most;
  }
  return best;
}

std::vector<double> Neighbours::difference(const Quantity& quantity, double length, const KeepGoing& keep_going) const {
  const auto at = [&](double by) { return moved(quantity, by, keep_going); };
  const auto far_up = at(2 * length), up = at(length), down = at(-length), far_down = at(-2 * length);
  std::vector<double> slopes(up.size());
  for (std::size_t i = 0; i < slopes.size(); ++i)
    slopes[i] = (8 * (up[i] - down[i]) - (far_up[i] - far_down[i])) / (12 * length);
  return slopes;
}

std::vector<double> Neighbours::moved(const Quantity& quantity, double by, const KeepGoing& keep_going) const {
  Request request = request_;
  auto scene = std::make_shared<Scene>(*request.scene);
  start_.move(quantity, by, *scene);
  request.scene = scene;
  if (quantity.kind == Quantity::Kind::parameter) set_parameters_of_events(request);
  const Solution ended = end_of(request, keep_going);
  std::vector<double> state;
  for (const std::size_t place : asked_.equations->variables)
    state.push_back(ended.stop.reason == ReturnCode::completed ? ended.final[place] : unknown);
  return state;
}

std::variant<Beginning, std::string> beyond_singular_start(const Request& request, const Solution& outcome,
                                                           const SensitivitiesAsked& asked, const Start& start,
                                                           double t, const KeepGoing& keep_going) {
  constexpr double longest = 0.05, part = 0.25;  // of the parameter's value, so that its sign does not change
  Request until = closely(request, outcome);
  until.end = t;
  const Neighbours neighbours(until, asked, start);
  Beginning made{t, {}, {}};
  for (const Quantity& by : asked.by) {
    if (by.kind != Quantity::Kind::parameter)
      return "the equations are singular at the start, and beside it no motion begins: there are derivatives by "
             "parameters alone";
    const double length = std::min(longest, part * std::abs(start.value(by)));
    if (!(length > 0))
      return "a parameter that is 0 cannot be changed to either side where the equations are singular at the start";
    if (!keep_going()) return no_time;
    if (made.state.empty()) made.state = neighbours.moved(by, 0, keep_going);
    made.slopes.push_back(neighbours.difference(by, length, keep_going));
    for (const auto* numbers : {&made.state, &made.slopes.back()})
      for (const double number : *numbers)
        if (!std::isfinite(number))
          return !keep_going() ? no_time : "the motion cannot be told from its neighbours shortly after its start";
  }
  return made;
}

}  // namespace least::variations
