// Table of the README: the cost of each accuracy, for our best scheme and for those of other libraries. Printed before
// the benchmarks.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/problems/spin_orbit.hpp"
#include "tests/bench/orbits.hpp"
#include "tests/bench/peers.hpp"
#include "tests/bench/table.hpp"
#include "tests/support/runs.hpp"

namespace {

using namespace least;
using namespace bench;

constexpr double far_for_ours = 10, far_for_peers = 50;

Contestant theirs(const TrueOrbit& orbit, const Peer& peer) {
  const auto measured = [&orbit, peer](double tolerance) -> Run {
    std::vector<double> states(orbit.times.size() * orbit.variables());
    const std::int64_t forces = peer.prepared(tolerance)(orbit.times, states.data());
    return {forces > 0 ? orbit.error(states) : std::numeric_limits<double>::quiet_NaN(), forces};
  };
  const auto prepared = [&orbit, peer](double tolerance) -> std::function<void()> {
    return [&orbit, solver = peer.prepared(tolerance), state = std::vector<double>(orbit.variables())]() mutable {
      solver({&orbit.scene.end, 1}, state.data());
    };
  };
  return {"`" + std::string(peer.name) + "`", 1, 1e-16, std::pow(10, 0.25), measured, prepared};
}

/// first() returns the first of the sorted entrants that fits, or nullptr.
template <class Fits>
const Entrant* first(const std::vector<Entrant>& all, Fits&& fits) {
  const auto found = std::ranges::find_if(all, fits);
  return found == all.end() ? nullptr : &*found;
}
auto by(Owner owner) {
  return [owner](const Entrant& entrant) { return entrant.contestant->owner == owner; };
}
auto called(std::string_view name) {
  return [name](const Entrant& entrant) { return entrant.contestant->name == name; };
}
bool is_peer(const Entrant& entrant) { return entrant.contestant->owner == Owner::peer; }
bool is_ours(const Entrant& entrant) { return !is_peer(entrant); }

/// missing() says why a cell is empty: the ladder's budget was spent, or its finest setting was not accurate enough.
std::string missing(const std::vector<Ladder>& ladders, std::string_view name) {
  for (const Ladder& ladder : ladders)
    if (ladder.contestant.name == name && ladder.given_up) return "– (dear)";
  return "– (never)";
}
std::string time_of(const Entrant* entrant) {
  char text[32] = "–";
  if (entrant) std::snprintf(text, sizeof text, entrant->us < 100 ? "%.1f" : "%.0f", entrant->us);
  return text;
}
std::string ratio_of(double theirs, double ours) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", theirs / ours);
  return text;
}
/// fewest() returns the smallest number of force evaluations of the entrants that fit; 0 where there are none.
template <class Fits>
std::int64_t fewest(const std::vector<Entrant>& all, Fits&& fits) {
  std::int64_t least = 0;
  for (const Entrant& entrant : all)
    if (fits(entrant) && (least == 0 || entrant.forces < least)) least = entrant.forces;
  return least;
}

/// Verdict counts what all cells of the table say together.
struct Verdict {
  int cells = 0, ahead_in_time = 0, ahead_in_forces = 0, well_ahead = 0;
  std::vector<std::string> not_ahead, not_well, goals;
} verdict;

/// Goals holds microseconds at each accuracy, for a machine whose step of leapfrog on Kepler takes 16 ns; 0: no goal.
using Goals = std::array<double, accuracies.size()>;

double leapfrog_step() {
  constexpr std::int64_t steps = 1'000'000;
  Request request = runs::defaults("kepler", "leapfrog");
  request.until_steps = true;
  request.steps = steps;
  runs::only_final(request);
  double seconds = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 5; ++k) seconds = std::min(seconds, runs::go(request).outcome.cost.seconds);
  return 1e9 * seconds / static_cast<double>(steps);
}

void row(const std::string& title, std::size_t accuracy, const std::vector<Ladder>& ladders, double goal) {
  std::vector<Entrant> all = entrants(ladders, accuracy);
  const std::int64_t our_forces = fewest(all, is_ours), their_forces = fewest(all, is_peer);
  race(all, 3);
  // The final race is between the fastest few only: five of our structure-keeping schemes, two of each other column.
  std::map<std::string, int> places;
  std::erase_if(all, [&](const Entrant& entrant) {
    const Contestant& who = *entrant.contestant;
    const bool structure = who.owner == Owner::structure;
    return ++places[structure ? "" : who.owner == Owner::taylor ? "taylor" : who.name] > (structure ? 5 : 2);
  });
  race(all, 15);
  const Entrant *structure = first(all, by(Owner::structure)), *ours = first(all, is_ours), *peer = first(all, is_peer);
  char choice[160] = "–";
  if (structure)
    std::snprintf(choice, sizeof choice, "%s, %s = %.3g", structure->contestant->name.c_str(),
                  std::string(structure->contestant->symbol).c_str(), structure->value);
  std::printf("| %s | %.0e | %s | %s |", title.c_str(), accuracies[accuracy], choice, time_of(structure).c_str());
  constexpr std::string_view taylor = "`taylor`";
  const Entrant* series = first(all, by(Owner::taylor));
  const std::string series_time =
      series ? time_of(series) + series->contestant->name.substr(taylor.size()) : missing(ladders, taylor);
  std::printf(" %s |", series_time.c_str());
  for (const char* name : {"`fehlberg_78`", "`dormand_prince_5`", "`bulirsch_stoer`", "`rk8pd`"}) {
    const Entrant* entrant = first(all, called(name));
    std::printf(" %s |", entrant ? time_of(entrant).c_str() : missing(ladders, name).c_str());
  }
  const auto count = [](std::int64_t forces) { return forces ? std::to_string(forces) : std::string("–"); };
  std::printf(" %s | %s |", count(our_forces).c_str(), count(their_forces).c_str());

  char cell[160];
  std::snprintf(cell, sizeof cell, "%s %.0e", title.c_str(), accuracies[accuracy]);
  const bool in_time = ours && (!peer || ours->us < peer->us);
  const bool in_forces = our_forces && (!their_forces || our_forces < their_forces);
  const bool well = ours && (!peer || ours->us <= 0.6 * peer->us);
  ++verdict.cells;
  verdict.ahead_in_time += in_time;
  verdict.ahead_in_forces += in_forces;
  verdict.well_ahead += well;
  if (!in_time || !in_forces)
    verdict.not_ahead.push_back(std::string(cell) + (in_time ? " (forces)" : in_forces ? " (time)" : ""));
  const std::string ratio = ours && peer ? ratio_of(ours->us, peer->us) : "–";
  if (goal > 0 && ours) {
    char words[200];
    std::snprintf(words, sizeof words, "%s %s of %.0f%s", cell, time_of(ours).c_str(), goal,
                  ours->us <= goal ? "" : " (over)");
    verdict.goals.emplace_back(words);
  }
  if (!well) verdict.not_well.push_back(std::string(cell) + " (" + ratio + ")");
  std::printf(" %s%s | %s |\n", ratio.c_str(), well ? "" : ", over",
              in_time && in_forces ? "yes"
              : in_time            ? "in time"
              : in_forces          ? "in forces"
                                   : "no");
}

void rows(const char* title, const Request& scene, const Goals& goals = {}) {
  if (!is_wanted(title)) return;
  const Progress told(title);
  const TrueOrbit orbit(scene);
  std::size_t above = 0;
  while (above < accuracies.size() && accuracies[above] >= 3 * orbit.floor) ++above;
  std::vector<Ladder> our, all;
  for (const SchemeConfig& choice : catalogue_candidates(*scene.scene->mechanics, {})) {
    const SchemeCard& card = schemes()[choice.scheme];
    if (card.id == "bulirsch_stoer")
      all.push_back({ours(orbit, choice)});
    else if (card.id == "taylor" || card.structure == "symplectic" || card.structure == "contact")
      our.push_back({ours(orbit, choice)});
  }
  for (const Peer& peer : peers(orbit.scene)) all.push_back({theirs(orbit, peer)});
  if (above > 0) {
    descend(our, above, far_for_ours);
    descend(all, above, far_for_peers);
  }
  all.insert(all.end(), our.begin(), our.end());
  for (std::size_t i = 0; i < above; ++i) row(title, i, all, goals[i] * leapfrog_step() / 16);
  for (std::size_t i = above; i < accuracies.size(); ++i)
    std::printf("| %s | %.0e | below the floor, %.0e | – | – | – | – | – | – | – | – | – | – |\n", title, accuracies[i],
                orbit.floor);
}

/// scene() is the problem from its default start to `end`, or to its default end where `end` is 0. Its scheme is only a
/// placeholder.
Request scene(std::string_view problem, double end) {
  const ProblemCard& card = runs::problem_card(problem);
  Request request = runs::defaults(problem, schemes()[card.schemes.front()].id);
  if (end > 0) request.end = end;
  return request;
}

}  // namespace

void bench::digits() {
  bench::heading("What a digit costs");
  std::printf(
      "Microseconds and force evaluations of a run whose largest error at 64 times along it is at most so much, by "
      "the\n"
      "fastest of our schemes that keep structure, by `taylor`, of the order that its tolerance calls for or of the "
      "one\n"
      "named, and by the solvers of Boost.Odeint and GSL, each at the\n"
      "coarsest setting that reaches it and keeps it when refined; `bulirsch_stoer` as it stands in the catalogue.\n");
  std::printf(
      "– (never): not at its finest setting. – (dear): not within %g s of trials, %.0e force evaluations a run and %g\n"
      "times (peers: %g times) what the cheapest needs. The goal is that the best of ours takes at most 0.6 of the "
      "best\n"
      "peer's time; ahead is what needs less than every peer of both time and force evaluations.\n\n",
      most_seconds, static_cast<double>(most_forces), far_for_ours, far_for_peers);
  std::printf(
      "| scene | error | ours, by structure | µs | `taylor` | `fehlberg_78` | `dormand_prince_5` | `bulirsch_stoer` | "
      "GSL rk8pd | fewest forces: ours | peers | best of ours / best peer, time | ahead |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  const double pi = std::acos(-1.0);
  Request round = scene("kepler", 200 * pi);
  runs::scene(round).initial = {0.4, 0, 0, 2};
  rows("Kepler, e = 0.6, 100 periods", round, {370, 470, 560, 700});
  rows("Kepler, e = 0.961, 10 periods", scene("kepler", 10 * 18.893743377439769));
  rows("damped oscillator, t = 100", scene("damped_oscillator", 100), {2, 2.5, 3, 3.5});
  rows("perturbed Kepler, e = 0.5, t = 50", scene("perturbed_kepler", 0));
  Request eccentric = scene("perturbed_kepler", 0);
  runs::scene(eccentric).initial = {0.1, 0, 0, std::sqrt(19.0), 0};
  rows("perturbed Kepler, e = 0.9, t = 50", eccentric);
  rows("damped Kepler, e = 0.9, t = 60", scene("damped_kepler", 0));
  rows("Lane–Emden, n = 3, t = 6.8", scene("lane_emden", 6.8));  // at its surface, 6.897, a run ends
  Request relaxation = scene("van_der_pol", 100);
  runs::set(relaxation, "epsilon", 10);
  rows("van der Pol, ε = 10, t = 100", relaxation, {40, 45, 55, 65});
  rows("spin–orbit, 100 periods", scene("spin_orbit", 200 * pi));
  rows("pendulum, 100 periods", scene("pendulum", 200 * pi));
  rows("Hénon–Heiles, t = 100", scene("henon_heiles", 100));
  rows("driven oscillator", scene("driven_oscillator", 0));
  rows("scalar-field cosmology", scene("scalar_field_cosmology", 0));
  const auto list = [](const std::vector<std::string>& cells) {
    std::string text = cells.empty() ? "none" : "";
    for (const std::string& cell : cells) text += (text.empty() ? "" : "; ") + cell;
    return text;
  };
  std::printf(
      "\nOf %d cells above their floor ours is ahead of every peer in time in %d, in force evaluations in %d; at 0.6 "
      "of\n"
      "the best peer's time or less in %d.\nNot ahead: %s.\nOver 0.6: %s.\nMicroseconds, where goals are set on a "
      "machine "
      "whose step of leapfrog takes 16 ns (%.1f ns here, so much\nmore they are given): %s.\n",
      verdict.cells, verdict.ahead_in_time, verdict.ahead_in_forces, verdict.well_ahead,
      list(verdict.not_ahead).c_str(), list(verdict.not_well).c_str(), leapfrog_step(), list(verdict.goals).c_str());
}
