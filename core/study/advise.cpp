#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "core/study/contest.hpp"

namespace least {
namespace {

std::string at(const Search& search, const Probe& probe) {
  return fmt::format("{} at {} = {:.4g}", search.name(), search.dial().name, probe.value);
}

std::string measured_by(const ErrorStudy& subject) {
  if (!subject.known())
    return fmt::format("{}, as the reference solution was not finished",
                       subject.has_stand_in() ? "against a finer run" : "by halving its step");
  return fmt::format("against the {}", subject.truth().how);
}

Message measured_up_to(const ErrorStudy& subject) {
  if (!subject.ends_early()) return {};
  return "; measured up to " + Message::time(subject.end(), 6) + ", shortly before the motion ends";
}

std::string growth_of(const Conditioning& known) {
  const double growth = known.growth_in(Norm::relative, false);
  const std::string times = std::isinf(growth) ? "beyond 1e308" : fmt::format("{:.2g}", growth);
  return times + (known.chaotic(Norm::relative) ? " times, exponentially" : " times");
}

/// obstacle says what keeps every scheme from the accuracy.
std::string obstacle(const Contest& contest, const Search& best, double accuracy) {
  const ErrorStudy& subject = contest.subject();
  if (subject.floor() > accuracy)
    return fmt::format("conditioning: differences of the start grow {}, so that errors below {:.1e} mean nothing",
                       growth_of(subject.conditioning()), subject.floor());
  if (best.stalled()) return "round-off: shorter steps do not help any more";
  if (contest.timed_out()) return "the time for the search ran out";
  if (best.too_dear()) return "more accurate runs would take more than 2e7 force evaluations";
  return "no finer run came nearer in the time for the search";
}

Alternative alternative(const Search& search, const Probe& probe) {
  return {search.choice(probe), probe.trial.forces, probe.trial.error, probe.trial.seconds};
}

/// tell_apart drops all but the first alternative of each scheme with a tolerance, whatever their other settings, and
/// those of the chosen scheme.
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

/// tell_what_is_known says how far errors are known: only as far as the reference is, and the motion goes.
void tell_what_is_known(Advice& advice, const ErrorStudy& subject) {
  advice.referenced = subject.known();
  advice.known = !advice.met || (subject.known() && !subject.partial());
}

/// is_allowed tells whether the pilot's scheme conserves what is to be conserved.
bool is_allowed(const Pilot& pilot, const std::vector<SchemeConfig>& all) {
  return pilot.choice && std::ranges::find(all, pilot.choice->scheme, &SchemeConfig::scheme) != all.end();
}

/// unmeasured advises the pilot's run, made before any was measured, where there is nothing else.
Advice unmeasured(const Request& scene, const Pilot& pilot, const std::vector<SchemeConfig>& all,
                  std::string_view why) {
  Advice advice;
  const auto cards = scene.scene->mechanics->schemes();
  advice.referenced = advice.known = false;
  const bool allowed = is_allowed(pilot, all);
  advice.choice = allowed ? *pilot.choice : all.front();
  const SchemeCard& card = cards[advice.choice->scheme];
  const ResolutionParameter dial(card);
  double value = dial.value(*advice.choice);
  if (!allowed && dial.name == "step") {
    constexpr double parts = 1000;
    value = std::min(value, (scene.end - scene.scene->start) / parts);
    advice.choice = dial.at(*advice.choice, value);
  }
  advice.reason = fmt::format("{}; {} at {} = {:.4g} is taken without a measured error", why,
                              name(card, *advice.choice), dial.name, value);
  if (allowed && pilot.completed)
    advice.reason += fmt::format(", as it came to its end in {:.2g} s", pilot.seconds);
  else if (allowed)
    advice.reason += ", which came to " + Message::time(pilot.end, 6) + fmt::format(" in {:.2g} s", pilot.seconds);
  return advice;
}

/// why_unmeasured says why nothing was measured.
std::string_view why_unmeasured(const Contest& contest, const Search* nearest) {
  if (contest.timed_out()) return "no run could be measured in the time for the search";
  return nearest ? "no run that was measured is near the motion" : "no run that was tried comes to the end";
}

Advice cheapest(Contest& contest, const Request& scene, const Pilot& pilot, const std::vector<SchemeConfig>& all,
                double accuracy) {
  Advice advice;
  contest.begin(pilot);
  contest.go();
  const Search* best = contest.winner();
  if (!best) {
    constexpr double nonsense = 0.1;  // comparable to the motion itself
    const Search* nearest = contest.runner_up();
    const double least = nearest ? nearest->best().trial.error : unknown;
    const bool measured = pilot.completed && contest.subject().known();
    if (!nearest || (!(least < nonsense) && is_allowed(pilot, all) && !measured))
      return unmeasured(scene, pilot, all, why_unmeasured(contest, nearest));
    choose(advice, *nearest, nearest->best());
    tell_what_is_known(advice, contest.subject());
    if (least <= accuracy) {  // but without the margin for errors between the times that were compared
      advice.known = false;
      advice.reason =
          fmt::format("{} has an error of {:.1e} {}, too near {:.1e} to be sure. {}", at(*nearest, nearest->best()),
                      least, measured_by(contest.subject()), accuracy, obstacle(contest, *nearest, accuracy));
    } else {
      advice.reason = fmt::format("nothing reaches {:.1e}; the best is {} with {:.1e}, {}. {}", accuracy,
                                  at(*nearest, nearest->best()), least, measured_by(contest.subject()),
                                  obstacle(contest, *nearest, accuracy));
    }
    advice.reason += measured_up_to(contest.subject());
    return advice;
  }
  contest.find_alternatives();
  best = contest.winner();  // an alternative may turn out to be cheaper
  const Probe& probe = *best->good();
  choose(advice, *best, probe);
  advice.met = true;
  tell_what_is_known(advice, contest.subject());
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
  if (best->limited_by_stability(contest.allowance())) advice.reason += "; longer steps are not stable (stiffness)";
  advice.reason += measured_up_to(contest.subject());
  if (contest.timed_out()) advice.reason += "; the time for the search ran out";
  return advice;
}

/// best_within advises the most accurate run that takes so many seconds.
Advice best_within(Contest& contest, const Request& scene, const Pilot& pilot, const std::vector<SchemeConfig>& all,
                   double seconds) {
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
      // A run would take longer than asked for, or is too far behind for its order to make up for it.
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
    if (pilot.completed && pilot.seconds <= seconds)
      return unmeasured(scene, pilot, all, why_unmeasured(contest, nullptr));
    advice.reason = fmt::format("no run completes within {:.3g} s", seconds);
    return advice;
  }
  choose(advice, *best, best_probe);
  advice.met = true;
  tell_what_is_known(advice, contest.subject());
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

/// horizon: where differences grow exponentially until errors at the end are meaningless, agreement there is by chance.
/// It returns the time up to which the accuracy can still be had; nothing for other motions.
std::optional<double> horizon(const Request& scene, const Conditioning& known, double accuracy) {
  constexpr double chance = 0.1, rounding = 0x1p-53, above = 1000;
  if (!known.chaotic(scene.norm) || !(rounding * known.growth_in(scene.norm, false) > chance)) return std::nullopt;
  // The growth is taken as exponential from one eighth of the span to the next.
  const double most = std::log(accuracy / (above * rounding));
  double last = 0, eighths = 0;
  for (const double growth : known.so_far_in(scene.norm)) {
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

/// act_that_ended returns the event that ended the pilot's run, if that event acts.
std::optional<Advice::Act> act_that_ended(const Request& scene, const Pilot& pilot) {
  const auto& names = scene.watched.list;
  for (std::size_t i = 0; i < std::min(scene.events.size(), names.size()); ++i)
    if (scene.events[i].act && names[i].card.name == pilot.event) return Advice::Act{pilot.event, pilot.end};
  return std::nullopt;
}

Advice advise_up_to_acts(const Request& scene, const Wish& wish, std::optional<Advice::Act>& act,
                         const std::atomic<bool>& cancelled) {
  constexpr double share = 0.5;   // of the time; the rest is for the run itself
  constexpr double pilots = 0.5;  // at most, of that share, for pilots
  constexpr double fine = 1e-6;   // far smaller than a motion, far larger than round-off
  const bool timed = std::isnan(wish.accuracy);
  const double accuracy = timed ? fine : wish.accuracy, start = scene.scene->start;
  const Deadline deadline(share * scene.limits.seconds);
  Advice advice;
  if (cancelled.load(std::memory_order_relaxed)) {
    advice.reason = "nobody waits for it";
    return advice;
  }
  const std::vector<SchemeConfig> all = suggested_candidates(*scene.scene, wish.keep);
  if (all.empty()) {
    advice.reason = "no scheme that applies to this problem keeps what is to be kept";
    return advice;
  }
  Request posed = scene;
  posed.norm = Norm::relative;              // whatever norm is asked for, components of all units shall count alike
  for (EventAsked& event : posed.events) {  // an act changes the motion: nothing is measured beyond
    event.stop = event.stop || event.act;
    event.act.reset();
  }
  const Pilot pilot =
      Pilot::run(posed, suggested_candidates(*scene.scene, {}), accuracy, pilots * deadline.left(), cancelled);
  act = act_that_ended(scene, pilot);
  if (!pilot.event.empty()) {
    if (!(pilot.end > start)) return unmeasured(posed, pilot, all, fmt::format("{} ends the run at once", pilot.event));
    posed.end = pilot.end;  // beyond it, the motion may be a different one, or undefined
  }
  constexpr double part = 0.01;  // of the scale of the motion
  const double grain = std::numeric_limits<double>::epsilon() * std::max(std::abs(start), std::abs(posed.end));
  if (const double scale = posed.scene->mechanics->scales(*posed.scene).time; scale > 0 && grain > part * scale)
    return unmeasured(
        posed, pilot, all,
        fmt::format("times up to {:.4g} are rounded by more than a hundredth of the motion's scale, {:.3g}", posed.end,
                    scale));
  constexpr double reference_cost = 8;  // at least, in units of a pilot's cost
  const bool hopeless = pilot.completed && reference_cost * pilot.seconds > deadline.left();
  const double half = hopeless ? deadline.left() : deadline.left() / 2;
  const auto known = conditioning(*posed.scene, posed.end,
                                  [&] { return deadline.left() > half && !cancelled.load(std::memory_order_relaxed); });
  auto until = horizon(posed, *known, accuracy);
  double seconds = wish.seconds;
  if (until && timed) {
    seconds *= (*until - start) / (posed.end - start);
    if (seconds < 1e-3) until.reset();  // the requested states would take most of the time
  }
  Request measured = posed;
  if (until) measured.end = *until;
  Contest contest(measured, all, timed ? 0 : accuracy, deadline.left(), hopeless ? 0 : deadline.left() / 2, cancelled,
                  until ? nullptr : known);
  if (contest.subject().ends_early() && !(contest.subject().end() > start))
    return unmeasured(posed, pilot, all, "the motion ends at once");
  advice = timed ? best_within(contest, posed, pilot, all, until ? seconds : wish.seconds)
                 : cheapest(contest, posed, pilot, all, accuracy);
  if (!pilot.event.empty() && advice.referenced)
    advice.reason +=
        "; measured up to " + Message::time(posed.end, 6) + fmt::format(", where {} ends the run", pilot.event);
  if (until && advice.choice) {
    advice.reason =
        fmt::format("errors at the end mean nothing, as differences of the start grow {}; up to ", growth_of(*known)) +
        Message::time(measured.end, 4) + ", " + advice.reason;
    advice.estimated_error = unknown;
    advice.met = timed;
    advice.known = !timed;
    advice.alternatives.clear();
  }
  return advice;
}

}  // namespace

Advice advise(const Request& scene, const Wish& wish, const std::atomic<bool>& cancelled) {
  std::optional<Advice::Act> act;
  Advice advice = advise_up_to_acts(scene, wish, act, cancelled);
  advice.before_act = std::move(act);
  return advice;
}

}  // namespace least
