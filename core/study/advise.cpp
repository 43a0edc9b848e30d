#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "core/study/search.hpp"

namespace least {
namespace {

/// All candidates at once, always the one whose next run is the cheapest, first among those that choose their steps,
/// until nothing cheaper can come.
class Contest {
 public:
  Contest(const Request& scene, const Keep& keep, double accuracy, double seconds, const std::atomic<bool>& cancelled)
      : cancelled_(cancelled),
        deadline_(seconds),
        subject_(scene, false, seconds / 2, cancelled),
        accuracy_(margin * accuracy) {
    for (SchemeConfig& choice : candidates(*scene.scene, keep))
      searches_.emplace_back(subject_, std::move(choice), accuracy_);
  }

  const ErrorStudy& subject() const { return subject_; }
  std::vector<Search>& searches() { return searches_; }
  double left() const { return cancelled_.load(std::memory_order_relaxed) ? 0 : deadline_.left(); }
  bool timed_out() const { return !(left() > 0); }

  /// The search with the cheapest run that is accurate enough; null: there is none.
  const Search* winner() const {
    const Search* best = nullptr;
    for (const Search& search : searches_)
      if (search.good() && (!best || search.likely_cost() < best->likely_cost())) best = &search;
    return best;
  }
  /// Where none is: the one with the smallest error, or one nearly as good that costs less.
  const Search* runner_up() {
    constexpr double near = 1.5;
    double least_error = 0;
    do {  // errors at few times are not the largest
      least_error = std::numeric_limits<double>::infinity();
      for (const Search& search : searches_) least_error = std::fmin(least_error, search.best().trial.error);
    } while (std::ranges::any_of(searches_, [&](Search& search) {
      return search.best().trial.error <= near * least_error && search.measure_best(left());
    }));
    const Search* best = nullptr;
    for (const Search& search : searches_)
      if (search.best().trial.error <= near * least_error &&
          (!best || search.best().trial.forces < best->best().trial.forces))
        best = &search;
    return best;
  }

  void go() {
    // Those that choose their steps come near the accuracy in few runs: what they cost says how far others need to go.
    // Where it does not within half of the time, the others have their turn.
    const double half = left() / 2;
    while (!timed_out()) {
      const double most = worth();
      const bool adaptive_first = left() > half;
      Search* next = nullptr;
      for (Search& search : searches_) {
        if (!winner() && beaten(search)) search.give_up();
        if (search.over() || !(search.least_cost() < most) || search.out_of_reach(aim(), most)) continue;
        const auto later = [&](const Search& one) {
          return std::pair(adaptive_first && !one.dial().adaptive(), one.least_cost());
        };
        if (!next || later(search) < later(*next)) next = &search;
      }
      if (!next) return;
      next->advance(left(), useful_steps(), most);
    }
  }

  /// Some more that grant the wish at not much more cost.
  void find_alternatives() {
    constexpr int enough = 3, most_runs = 16;
    const Search* best = winner();
    const double most = 4 * std::max(best->likely_cost(), 10.0);
    const auto told = [&](const Search& search) {  // by itself, or by one before it
      return std::ranges::any_of(searches_, [&](const Search& other) {
        return (&other == best || (other.good() && &other < &search)) && search.twin_of(other);
      });
    };
    const auto found = [&] {
      return std::ranges::count_if(
          searches_, [&](const Search& search) { return search.good() && &search != best && !told(search); });
    };
    for (int run = 0; run < most_runs && found() < enough && !timed_out(); ++run) {
      Search* next = nullptr;
      for (Search& search : searches_)
        if (!search.over() && !search.good() && !told(search) &&
            search.likely_cost() < (next ? next->likely_cost() : most))
          next = &search;
      if (!next) return;
      next->advance(left(), useful_steps(), std::numeric_limits<double>::infinity());
    }
  }

 private:
  /// Errors below the floor mean nothing, and those of long runs end somewhat above: where the accuracy is smaller,
  /// this is about as near as anything comes.
  double aim() const {
    constexpr double above = 10;
    return subject_.floor() > accuracy_ ? above * subject_.floor() : accuracy_;
  }
  /// Where a run has to cost less to be of interest.
  double worth() const {
    constexpr double less = 1.05, more = 1.1;
    if (const Search* best = winner()) return best->likely_cost() / less;
    double most = std::numeric_limits<double>::infinity();
    for (const Search& search : searches_)
      if (search.best().trial.error <= aim()) most = std::fmin(most, static_cast<double>(search.best().trial.forces));
    return more * most;  // what is more accurate at little more cost
  }
  /// A run of more has nothing to offer beside the best.
  std::int64_t useful_steps() const {
    const Search* best = winner();
    return best ? std::min<std::int64_t>(1000 + 8 * best->good()->trial.forces, Search::most_forces)
                : Search::most_forces;
  }
  /// Whether one that has come to its end was better at much less cost.
  bool beaten(const Search& search) const {
    return std::ranges::any_of(searches_, [&](const Search& other) {
      return other.over() && !search.over() && search.bad() && other.best().trial.error < search.bad()->trial.error &&
             static_cast<double>(other.best().trial.forces) < search.least_cost() / 4;
    });
  }

  /// Between the times at which runs are held against the truth their errors may be somewhat larger.
  static constexpr double margin = 0.87;

  const std::atomic<bool>& cancelled_;
  Deadline deadline_;
  ErrorStudy subject_;
  double accuracy_;
  std::vector<Search> searches_;
};

std::string at(const Search& search, const Probe& probe) {
  return fmt::format("{} at {} = {:.4g}", search.name(), search.dial().name, probe.value);
}

std::string measured_by(const ErrorStudy& subject) {
  if (!subject.known()) return "by halving its step, as the reference solution was not finished";
  return fmt::format("against the {}", subject.truth().how);
}

std::string measured_up_to(const ErrorStudy& subject) {
  if (!subject.ends_early()) return {};
  return fmt::format("; measured up to t = {:.6g}, shortly before the motion ends", subject.end());
}

std::string growth_of(const Conditioning& known) {
  const std::string times = std::isinf(known.most_growth) ? "beyond 1e308" : fmt::format("{:.2g}", known.most_growth);
  return times + (known.chaotic() ? " times, exponentially" : " times");
}

/// What keeps every scheme from the accuracy.
std::string obstacle(const Contest& contest, const Search& best, double accuracy) {
  const ErrorStudy& subject = contest.subject();
  if (subject.floor() > accuracy)
    return fmt::format("conditioning: differences of the start grow {}, so that errors below {:.1e} mean nothing",
                       growth_of(subject.conditioning()), subject.floor());
  if (best.stalled()) return "round-off: shorter steps do not help any more";
  if (contest.timed_out()) return "the time for the search ran out";
  return "more accurate runs would take more than 2e7 force evaluations";
}

Alternative alternative(const Search& search, const Probe& probe) {
  return {search.choice(probe), probe.trial.forces, probe.trial.error, probe.trial.seconds};
}

/// Of a scheme that goes by its tolerance, however it chooses the rest, the first is told, or the choice itself.
void tell_apart(Advice& advice, const ErrorStudy& subject) {
  std::set<std::size_t> told{advice.choice->scheme};
  std::erase_if(advice.alternatives, [&](const Alternative& other) {
    return ResolutionParameter(subject.card(other.scheme)).adaptive() && !told.insert(other.scheme.scheme).second;
  });
}

void choose(Advice& advice, const Search& search, const Probe& probe) {
  advice.choice = search.choice(probe);
  advice.estimated_error = probe.trial.error;
}

Advice cheapest(Contest& contest, double accuracy) {
  Advice advice;
  contest.go();
  const Search* best = contest.winner();
  if (!best) {
    const Search* nearest = contest.runner_up();
    if (!nearest) {
      advice.reason = contest.timed_out() ? "no run completed within the time for the search"
                                          : "no scheme completes a run: stiffness, or a motion that ends at once";
      return advice;
    }
    choose(advice, *nearest, nearest->best());
    advice.reason = fmt::format("nothing reaches {:.1e}; the best is {} with {:.1e}, {}. {}", accuracy,
                                at(*nearest, nearest->best()), advice.estimated_error, measured_by(contest.subject()),
                                obstacle(contest, *nearest, accuracy));
    return advice;
  }
  contest.find_alternatives();
  const Probe& probe = *best->good();
  choose(advice, *best, probe);
  advice.met = true;
  for (const Search& search : contest.searches())
    if (&search != best && search.good()) advice.alternatives.push_back(alternative(search, *search.good()));
  std::ranges::stable_sort(advice.alternatives, {}, &Alternative::force_evaluations);
  tell_apart(advice, contest.subject());
  advice.reason = fmt::format("{} has an error of {:.1e} {}, with {} force evaluations: the fewest of {} candidates",
                              at(*best, probe), probe.trial.error, measured_by(contest.subject()), probe.trial.forces,
                              contest.searches().size());
  if (!advice.alternatives.empty())
    advice.reason += fmt::format(
        "; {} takes {:.2f} times as many",
        name(contest.subject().card(advice.alternatives.front().scheme), advice.alternatives.front().scheme),
        static_cast<double>(advice.alternatives.front().force_evaluations) /
            static_cast<double>(std::max<std::int64_t>(probe.trial.forces, 1)));
  if (best->limited_by_stability(contest.left())) advice.reason += "; longer steps are not stable (stiffness)";
  advice.reason += measured_up_to(contest.subject());
  if (contest.timed_out()) advice.reason += "; the time for the search ran out";
  return advice;
}

/// The most accurate run that takes so many seconds.
Advice best_within(Contest& contest, double seconds) {
  Advice advice;
  const auto finest = [](const Search& search) { return search.bad() ? search.bad()->trial.seconds : 0; };
  double least_error = std::numeric_limits<double>::infinity();
  const Search* best = nullptr;
  Probe best_probe;
  std::vector<std::optional<Probe>> within(contest.searches().size());
  while (!contest.timed_out()) {
    Search* next = nullptr;
    for (Search& search : contest.searches()) {
      const double error = search.best().trial.error, ahead = seconds / finest(search);
      const double order = std::max<double>(std::max(search.declared_order(), 1), search.seen_order(12));
      // Longer than asked for, or so far behind that its order will not make up for it.
      if (2 * finest(search) > seconds || (error < 1e-2 && error * std::pow(ahead, -1.5 * order) > 10 * least_error))
        search.give_up();
      if (!search.over() && (!next || finest(search) < finest(*next))) next = &search;
    }
    if (!next) break;
    next->advance(contest.left(), Search::most_forces, std::numeric_limits<double>::infinity());
    const Probe& probe = next->best();
    if (probe.trial.seconds > seconds || !(probe.trial.error >= 0)) continue;
    within[static_cast<std::size_t>(next - contest.searches().data())] = probe;
    if (!(probe.trial.error < least_error)) continue;
    least_error = probe.trial.error;
    best = next;
    best_probe = probe;
  }
  if (!best) {
    advice.reason = fmt::format("no run completes within {:.3g} s", seconds);
    return advice;
  }
  choose(advice, *best, best_probe);
  advice.met = true;
  for (std::size_t i = 0; i < within.size(); ++i)
    if (within[i] && &contest.searches()[i] != best)
      advice.alternatives.push_back(alternative(contest.searches()[i], *within[i]));
  std::ranges::stable_sort(advice.alternatives, {}, &Alternative::estimated_error);
  tell_apart(advice, contest.subject());
  advice.alternatives.resize(std::min<std::size_t>(advice.alternatives.size(), 5));
  std::ranges::stable_sort(advice.alternatives, {}, &Alternative::force_evaluations);
  advice.reason = fmt::format("{} has the smallest error of what was measured within {:.3g} s: {:.1e} {}, in {:.2g} s",
                              at(*best, best_probe), seconds, best_probe.trial.error, measured_by(contest.subject()),
                              best_probe.trial.seconds);
  return advice;
}

/// Where differences grow exponentially until errors at the end mean nothing, whatever comes nearest there does so by
/// chance: the time up to which this accuracy is still to be had.
std::optional<double> horizon(const Request& scene, const Conditioning& known, double accuracy) {
  constexpr double chance = 0.1, rounding = 0x1p-53, above = 1000;
  if (!known.chaotic() || !(rounding * known.growth_in(scene.norm, false) > chance)) return std::nullopt;
  // Exponentially from one eighth of the span to the next.
  const double most = std::log(accuracy / (above * rounding));
  double last = 0, eighths = 0;
  for (const double growth : known.so_far) {
    const double next = std::log(std::min(growth, std::numeric_limits<double>::max()));
    if (next > most) {
      eighths += std::max(most - last, 0.0) / (next - last);
      break;
    }
    last = next;
    ++eighths;
  }
  if (!(eighths > 0)) return std::nullopt;
  const double start = scene.scene->start, end = known.ends ? known.reached : scene.end;
  return start + (end - start) * eighths / Conditioning::parts;
}

}  // namespace

Advice advise(const Request& scene, const Wish& wish, const std::atomic<bool>& cancelled) {
  const bool timed = std::isnan(wish.accuracy);
  constexpr double fine = 1e-6;  // far below what a motion is, far above round-off
  const Deadline deadline(scene.limits.seconds);
  const auto known = conditioning(*scene.scene, scene.end, [&] {
    return deadline.left() > scene.limits.seconds / 2 && !cancelled.load(std::memory_order_relaxed);
  });
  auto until = horizon(scene, *known, timed ? fine : wish.accuracy);
  const double start = scene.scene->start;
  double seconds = wish.seconds;
  if (until && timed) {
    seconds *= (*until - start) / (scene.end - start);
    if (seconds < 1e-3) until.reset();  // the states that are asked for would be most of the time
  }
  Request measured = scene;
  if (until) measured.end = *until;
  Contest contest(measured, wish.keep, timed ? 0 : wish.accuracy, deadline.left(), cancelled);
  Advice advice;
  if (contest.searches().empty()) {
    advice.reason = "no scheme that applies to this problem keeps what is to be kept";
    return advice;
  }
  if (contest.subject().ends_early() && !(contest.subject().end() > start)) {
    advice.reason = "the motion ends at once";
    return advice;
  }
  advice = timed ? best_within(contest, until ? seconds : wish.seconds) : cheapest(contest, wish.accuracy);
  if (until && advice.choice) {
    advice.reason =
        fmt::format("errors at the end mean nothing, as differences of the start grow {}; up to t = {:.4g}, {}",
                    growth_of(*known), *until, advice.reason);
    advice.estimated_error = unknown;
    advice.met = timed;
    advice.alternatives.clear();
  }
  return advice;
}

}  // namespace least
