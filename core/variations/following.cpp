#include "core/variations/following.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/run/messages.hpp"
#include "core/variations/neighbours.hpp"
#include "core/variations/varied_motion.hpp"

namespace least::variations {
namespace {

/// Chosen is a group of directions, and of pairs by their places in that group.
struct Chosen {
  std::vector<std::size_t> directions;
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
};

/// Follower follows a group from the start of a question to its end.
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

  Followed go() {
    follow();
    return std::move(made_);
  }

 private:
  /// follow() reaches the end, or returns false and leaves the reason.
  bool follow() {
    auto event = question_.events.begin();
    const auto to_event = [&](double t) {
      while (event != question_.events.end() && (!event->asked || event->t < t))
        if (const RunEvent& next = *event++; next.asked && !meet(next)) return false;
      return true;
    };
    for (const double t : question_.times)
      if (!to_event(t) || !look(t)) return false;
    return to_event(std::nextafter(question_.end, std::numeric_limits<double>::infinity())) && look(question_.end);
  }

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
        made_.reason = no_time;
        return false;
      }
      if (!motion_.advance(question_.end)) return ends();
    }
    return motion_.look(t) || ends();
  }
  bool ends() {
    const double t = question_.asked.equations->backward ? 0 - motion_.time() : motion_.time();
    made_.reason = "the motion and its derivatives cannot be followed beyond t = " + messages::number(t);
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

  /// meet finds the event along the motion, close to where the run had it, and applies what it does.
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
                                 std::span(all.second).subspan(pair * size, size), !event.ends_run),
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
};

Followed follow(const Question& question, const Chosen& chosen, double tolerance, int order) {
  return Follower(question, chosen, tolerance, order).go();
}

/// append_each appends the numbers of another group at each time that both groups have reached.
void append_each(std::vector<std::vector<double>>&& from, std::vector<std::vector<double>>& to) {
  to.resize(std::min(to.size(), from.size()));
  for (std::size_t i = 0; i < to.size(); ++i) {
    to[i].insert(to[i].end(), from[i].begin(), from[i].end());
    from[i] = {};
  }
}

/// join adds the directions of another group to those of the groups before it.
void join(Followed&& group, Followed& all) {
  append_each(std::move(group.slopes), all.slopes);
  append_each(std::move(group.time_slopes), all.time_slopes);
  all.state = std::move(group.state);
  if (all.reason.empty()) all.reason = std::move(group.reason);
}

/// nothing returns what was followed where directions are missing.
Followed nothing(std::string reason) {
  Followed none;
  none.reason = std::move(reason);
  return none;
}

}  // namespace

int order_of_control(int order) {
  constexpr int higher = 3;
  return std::min(order + higher, tape::Series::most_orders);
}

Followed follow_all(const Question& question, double tolerance, int order) {
  Followed all;
  for (std::size_t first = 0, count = question.directions.size(); first < question.directions.size();) {
    count = std::min(count, question.directions.size() - first);
    if (!question.keep_going()) return nothing(no_time);
    try {
      Chosen chosen;
      for (std::size_t d = first; d < first + count; ++d) chosen.directions.push_back(d);
      Followed group = follow(question, chosen, tolerance, order);
      if (first == 0)
        all = std::move(group);
      else
        join(std::move(group), all);
      first += count;
    } catch (const tape::TooManyOperations&) {
      if (count == 1) return nothing("the equations of their derivatives are too long");
      count = (count + 1) / 2;
    }
  }
  return all;
}

std::variant<std::vector<double>, std::string> follow_pairs(
    const Question& question, const std::vector<std::pair<std::size_t, std::size_t>>& pairs, double tolerance,
    int order) {
  const auto of = [&](const Chosen& chosen) -> std::variant<std::vector<double>, std::string> {
    Followed followed = follow(question, chosen, tolerance, order);
    if (!followed.reason.empty()) return std::move(followed.reason);
    return std::move(followed.second);
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

}  // namespace least::variations
