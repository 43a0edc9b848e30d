#include "core/variations/sensitivities.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "core/run/messages.hpp"
#include "core/variations/event_slopes.hpp"
#include "core/variations/neighbours.hpp"
#include "core/variations/random_direction.hpp"
#include "core/variations/rows.hpp"
#include "core/variations/run_events.hpp"
#include "core/variations/start.hpp"
#include "core/variations/varied_motion.hpp"

namespace least::variations {
namespace {

/// The motion with some of its directions.
struct Followed {
  std::vector<double> state;                     ///< at the end
  std::vector<std::vector<double>> slopes;       ///< at samples, and at last at the end; direction by direction
  std::vector<std::vector<double>> time_slopes;  ///< of each event that was asked for, by direction
  std::vector<double> second;                    ///< the second ones, at the end: pair by pair
  std::vector<std::vector<double>> control;      ///< where slopes are, in one direction; fewer: not to the end
  int order = 0;
};

struct Question {
  const SensitivitiesAsked& asked;
  double began, end;
  std::vector<double> times;  ///< of samples, that do not decrease
  const KeepGoing& keep_going;
  Start start;
  std::vector<double> state;  ///< where it began
  const std::vector<RunEvent>& events;
  const EventSlopes& slopes_of_events;
  std::vector<Direction> directions{};
  std::vector<std::vector<double>> slopes{};
  std::vector<double> weights{};  ///< of the directions in that of a control beside them; none: there is none
};

/// That of the series of a control, beside series of this one.
int order_of_control(int order) {
  constexpr int higher = 3;
  return std::min(order + higher, tape::Series::most_orders);
}

/// Some of the directions, and pairs of these.
struct Chosen {
  std::vector<std::size_t> directions;
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
};

/// Follows them from the start of a question to its end.
class Follower {
 public:
  Follower(const Question& question, const Chosen& chosen, double tolerance, int order)
      : question_(question),
        directions_(directions_of(question, chosen)),
        pairs_(chosen.pairs),
        motion_(*question.asked.equations, directions_, chosen.pairs, tolerance, order) {
    Derivatives beginning;
    for (const std::size_t d : chosen.directions) append(question.slopes[d], beginning.first);
    const auto& by = question.asked.by;
    for (const auto& [a, b] : chosen.pairs)
      append(question.start.second(by[chosen.directions[a]], by[chosen.directions[b]]), beginning.second);
    made_.order = motion_.order();
    if (question.weights.empty() || chosen.directions.size() < question.directions.size() || !chosen.pairs.empty())
      motion_.start(question.state, beginning, question.began);
    else
      motion_.start_with_control(question.state, beginning, question.began, question.weights,
                                 order_of_control(made_.order));
  }

  /// What was found, or why they were not followed to the end.
  std::variant<Followed, std::string> go() {
    auto event = question_.events.begin();
    const auto to_event = [&](double t) {
      while (event != question_.events.end() && (!event->asked || event->t < t))
        if (const RunEvent& next = *event++; next.asked && !meet(next)) return false;
      return true;
    };
    for (const double t : question_.times)
      if (!to_event(t) || !look(t)) return why_;
    if (!to_event(std::numeric_limits<double>::infinity()) || !look(question_.end)) return why_;
    return std::move(made_);
  }

 private:
  static std::vector<Direction> directions_of(const Question& question, const Chosen& chosen) {
    std::vector<Direction> directions;
    for (const std::size_t d : chosen.directions) directions.push_back(question.directions[d]);
    return directions;
  }
  static void append(const std::vector<double>& from, std::vector<double>& to) {
    to.insert(to.end(), from.begin(), from.end());
  }

  bool reach(double t) {
    while (t > std::max(motion_.reach(), motion_.time())) {
      if (!question_.keep_going()) {
        why_ = no_time;
        return false;
      }
      if (!motion_.advance(question_.end)) return ends();
    }
    return motion_.look(t) || ends();
  }
  bool ends() {
    const double t = question_.asked.equations->backward ? 0 - motion_.time() : motion_.time();
    why_ = "the motion and its derivatives cannot be followed beyond t = " + messages::number(t);
    return false;
  }

  bool look(double t) {
    if (!reach(t)) return false;
    made_.state.assign(motion_.state().begin(), motion_.state().end());
    Derivatives now = motion_.derivatives();
    made_.slopes.push_back(std::move(now.first));
    made_.second = std::move(now.second);
    if (auto control = motion_.control()) made_.control.push_back(std::move(*control));
    return true;
  }

  /// An event as the motion has it, near to where the run met it, and what it does.
  bool meet(const RunEvent& event) {
    constexpr int rounds = 3;
    const EventSlopes& slopes = question_.slopes_of_events;
    double t = event.t;
    if (!reach(t)) return false;
    for (int round = 0; round < rounds; ++round) {
      const double missing = slopes.missing(*event.asked, t, motion_.state());
      if (!(std::abs(missing) < 0.01 * (question_.end - question_.began)) || !motion_.look(t + missing)) break;
      t += missing;
    }
    if (!motion_.look(t)) return ends();
    const std::vector<double> state(motion_.state().begin(), motion_.state().end());
    const Derivatives all = motion_.derivatives();
    const std::size_t size = state.size();
    const auto slope_of = [&](std::size_t d) { return std::span(all.first).subspan(d * size, size); };
    auto& told = made_.time_slopes.emplace_back();
    Derivatives after;
    for (std::size_t d = 0; d < directions_.size(); ++d) {
      const auto slope = slope_of(d);
      told.push_back(slopes.time_slope(*event.asked, t, state, slope, directions_[d]));
      if (slopes.acts(*event.asked))
        append(slopes.slope_after(*event.asked, t, state, slope, directions_[d]), after.first);
    }
    if (!slopes.acts(*event.asked)) return true;
    for (std::size_t pair = 0; pair < pairs_.size(); ++pair) {
      const auto [a, b] = pairs_[pair];
      append(slopes.second_after(*event.asked, t, state, {slope_of(a), directions_[a]}, {slope_of(b), directions_[b]},
                                 std::span(all.second).subspan(pair * size, size)),
             after.second);
    }
    motion_.start(slopes.state_after(*event.asked, t, state), after, t);
    return true;
  }

  const Question& question_;
  std::vector<Direction> directions_;
  std::vector<std::pair<std::size_t, std::size_t>> pairs_;
  VariedMotion motion_;
  Followed made_;
  std::string why_;
};

std::variant<Followed, std::string> follow(const Question& question, const Chosen& chosen, double tolerance,
                                           int order) {
  return Follower(question, chosen, tolerance, order).go();
}

void append_each(std::vector<std::vector<double>>&& from, std::vector<std::vector<double>>& to) {
  if (to.empty()) {
    to = std::move(from);
    return;
  }
  for (std::size_t i = 0; i < from.size(); ++i) {
    to[i].insert(to[i].end(), from[i].begin(), from[i].end());
    from[i] = {};
  }
}

/// All of them, in as few parts as are short enough.
std::variant<Followed, std::string> follow_all(const Question& question, double tolerance, int order) {
  Followed all;
  for (std::size_t first = 0, count = question.directions.size(); first < question.directions.size();) {
    count = std::min(count, question.directions.size() - first);
    if (!question.keep_going()) return no_time;
    try {
      Chosen chosen;
      for (std::size_t d = first; d < first + count; ++d) chosen.directions.push_back(d);
      auto part = follow(question, chosen, tolerance, order);
      if (auto* why = std::get_if<std::string>(&part)) return std::move(*why);
      auto& made = std::get<Followed>(part);
      all.order = made.order;
      all.state = std::move(made.state);
      all.control = std::move(made.control);
      append_each(std::move(made.slopes), all.slopes);
      append_each(std::move(made.time_slopes), all.time_slopes);
      first += count;
    } catch (const tape::TooManyOperations&) {
      if (count == 1) return "the equations of their derivatives are too long";
      count = (count + 1) / 2;
    }
  }
  return all;
}

/// Second derivatives at the end: all at once, or pair by pair where that is too long.
std::variant<std::vector<double>, std::string> follow_pairs(
    const Question& question, const std::vector<std::pair<std::size_t, std::size_t>>& pairs, double tolerance,
    int order) {
  const auto of = [&](const Chosen& chosen) -> std::variant<std::vector<double>, std::string> {
    auto followed = follow(question, chosen, tolerance, order);
    if (auto* why = std::get_if<std::string>(&followed)) return std::move(*why);
    return std::move(std::get<Followed>(followed).second);
  };
  try {
    Chosen all{{}, pairs};
    for (std::size_t d = 0; d < question.directions.size(); ++d) all.directions.push_back(d);
    return of(all);
  } catch (const tape::TooManyOperations&) {
  }
  std::vector<double> second;
  for (const auto& [a, b] : pairs) {
    if (!question.keep_going()) return no_time;
    try {
      auto one = of(a == b ? Chosen{{a}, {{0, 0}}} : Chosen{{a, b}, {{0, 1}}});
      if (auto* why = std::get_if<std::string>(&one)) return std::move(*why);
      const auto& made = std::get<std::vector<double>>(one);
      second.insert(second.end(), made.begin(), made.end());
    } catch (const tape::TooManyOperations&) {
      return "the equations of their second derivatives are too long";
    }
  }
  return second;
}

/// What a control in one direction says of all of them, at samples and at the end: the one that went beside them, or,
/// where steps do not lie ready or an event acts, one that is followed now, with half the tolerance and through the
/// same events. Second derivatives have controls of their own, of all pairs.
double doubt_of(const Question& question, const Followed& all, double tolerance, int order) {
  if (all.control.size() == all.slopes.size()) return disagreement_along(all.slopes, question.weights, all.control);
  Held of_control = HeldByThread::take(bytes_of_lists(all.slopes.size(), all.state.size()));
  Question one = question;
  std::vector<double> starts;
  for (const auto& slope : question.slopes) starts.insert(starts.end(), slope.begin(), slope.end());
  one.directions = {sum_of(question.directions, question.weights)};
  one.slopes = {sum_of(starts, question.weights)};
  one.weights.clear();
  const auto control = follow_all(one, tolerance, order);
  const auto* known = std::get_if<Followed>(&control);
  return known != nullptr ? disagreement_along(all.slopes, question.weights, known->slopes) : unknown;
}

/// All second derivatives, with a control.
void add_second(const Question& question, double tolerance, int control_order, Sensitivities& found) {
  const ParametricScene& equations = *question.asked.equations;
  for (std::size_t a = 0; a < question.directions.size(); ++a)
    for (std::size_t b = a; b < question.directions.size(); ++b) found.pairs.emplace_back(a, b);
  Question of_end = question;
  of_end.times.clear();
  auto second = follow_pairs(of_end, found.pairs, tolerance, 0);
  if (auto* why = std::get_if<std::string>(&second)) {
    found.reason = std::move(*why);
    return;
  }
  found.second = in_rows(equations, std::get<std::vector<double>>(second));
  const auto other = follow_pairs(of_end, found.pairs, tolerance / 2, control_order);
  if (const auto* known = std::get_if<std::vector<double>>(&other))
    found.uncertainty = std::max(found.uncertainty, disagreement({found.second}, {in_rows(equations, *known)}));
}

/// Begins a little later where the start is singular, or says why it cannot. The slopes at the start itself, for each
/// of the times that were asked for there, which are no longer among them.
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
  const std::vector<RunEvent> events = events_of(request, outcome);
  const EventSlopes slopes_of_events(request, asked.equations);
  Question question{asked, scene.start, outcome.t,       {times.begin(), times.end()}, keep_going, Start(scene, asked),
                    {},    events,      slopes_of_events};
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
  const auto at_start = leave_singular_start(request, outcome, question, found.reason);
  if (!found.reason.empty()) return found;
  auto followed = follow_all(question, tolerance, 0);
  if (auto* why = std::get_if<std::string>(&followed)) {
    found.reason = std::move(*why);
    return found;
  }
  auto& all = std::get<Followed>(followed);
  const int control_order = order_of_control(all.order);
  found.uncertainty = doubt_of(question, all, tolerance / 2, control_order);

  all.slopes.insert(all.slopes.begin(), at_start.begin(), at_start.end());

  auto time_slopes = all.time_slopes.begin();
  for (const RunEvent& event : events) {
    auto& told = found.events.emplace_back(event.name, std::vector<double>(asked.by.size(), unknown)).second;
    if (!event.asked) continue;
    told = std::move(*time_slopes++);
    if (event.ends_run) {  // what the run ends with is the state at a time that changes, too
      const std::vector<double> rates = slopes_of_events.rates(event.t, all.state);
      for (std::size_t d = 0; d < told.size(); ++d)
        for (std::size_t i = 0; i < rates.size(); ++i) all.slopes.back()[d * rates.size() + i] += rates[i] * told[d];
    }
    for (double& slope : told) slope *= equations.sign_of_time();
  }
  const std::vector<double> at_end = all.slopes.back();
  for (auto& slopes : all.slopes) {
    found.samples.push_back(in_rows(equations, slopes));
    slopes = {};
  }
  found.final = std::move(found.samples.back());
  found.samples.pop_back();
  if (switches(equations)) {  // what is made of their jumps is held against runs
    const Neighbours neighbours(closely(request, outcome), asked, question.start);
    if (const auto others = neighbours.differences(at_end, keep_going)) {
      const double doubt = disagreement({found.final}, {in_rows(equations, *others)});
      if (!(doubt <= found.uncertainty)) found.uncertainty = doubt;
    } else {
      found.uncertainty = unknown;
    }
  }
  if (asked.whole_start) found.structure = structure_of(equations, question.start.state(), all.state, found.final);
  if (asked.order == 2 && outcome.event.empty()) add_second(question, tolerance, control_order, found);
  return found;
}

}  // namespace least::variations
