// Table of RESULTS.md: rotating frames and magnetic fields, by the explicit maps of lifted_splitting, by implicit
// schemes that keep as much, and by schemes that keep nothing. Printed before the benchmarks.
#include "tests/support/lifted.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "tests/bench/orbits.hpp"
#include "tests/bench/table.hpp"

namespace {

using namespace least;
using namespace bench;

constexpr double far = 100;  // a scheme that costs so many times as much as the cheapest is left out
constexpr const char *frames = "lifted_splitting", *turns = "boris", *paced = "adaptive_boris",
                     *implicit = "contact_gauss", *series = "taylor";

/// column_of() returns the column of a contestant; empty where it has none.
std::string_view column_of(const Contestant& contestant) {
  for (const std::string_view id : {frames, turns, implicit, series})
    if (contestant.name.starts_with("`" + std::string(id))) return id;
  if (contestant.name.starts_with("`" + std::string(paced))) return turns;
  return contestant.owner == Owner::peer ? "measure" : "";
}

std::string cell(const std::map<std::string_view, const Entrant*>& best, std::string_view column) {
  const auto found = best.find(column);
  if (found == best.end()) return "–";
  char text[32];
  std::snprintf(text, sizeof text, found->second->us < 100 ? "%.1f" : "%.0f", found->second->us);
  return text;
}

/// choice_of() returns the step of the best entrant of a column, and the settings that the heading does not name.
std::string choice_of(const std::map<std::string_view, const Entrant*>& best, std::string_view column) {
  const auto found = best.find(column);
  if (found == best.end()) return "–";
  std::string name = found->second->contestant->name;  // `id` and its settings
  if (name.starts_with("`" + std::string(column))) {
    name.erase(0, column.size() + 2);
    name.erase(0, name.find_first_not_of(", "));
  }
  char text[32];
  std::snprintf(text, sizeof text, "%sh = %.3g", name.empty() ? "" : ", ", found->second->value);
  return name + text;
}
std::string ratio(const std::map<std::string_view, const Entrant*>& best, std::string_view column) {
  if (!best.contains(column) || !best.contains(series)) return "–";
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", best.at(column)->us / best.at(series)->us);
  return text;
}

void rows(const char* title, const lifted::Scene& of, double end) {
  if (!is_wanted(title)) return;
  const Progress told(title);
  const auto mechanics = texts::mechanics_of(of.definition);
  Request scene = lifted::request_of(of, mechanics, 0.01, end);
  if (least::Scene& start = runs::scene(scene); mechanics->text()->takes_velocities())
    mechanics->text()->velocities_to_momenta(start.parameters, 0, start.initial);
  const TrueOrbit orbit(scene);
  std::vector<Ladder> ladders;
  for (const SchemeConfig& choice : catalogue_candidates(*mechanics, {})) {
    const SchemeCard& card = schemes()[choice.scheme];
    const bool measure = card.own_clock && card.id != series && card.id != paced;
    if (card.structure == "none" && !card.own_clock) continue;
    ladders.push_back({ours(orbit, choice)});
    if (measure) ladders.back().contestant.owner = Owner::peer;
  }
  std::size_t above = 0;
  while (above < accuracies.size() && accuracies[above] >= 3 * orbit.floor) ++above;
  if (above == 0) std::printf("| %s | below the floor, %.0e | – | – | – | – | – | – | – | – |\n", title, orbit.floor);
  if (above == 0) return;
  descend(ladders, above, far);
  for (std::size_t i = 0; i < above; ++i) {
    std::vector<Entrant> all = entrants(ladders, i);
    race(all, 9);
    std::map<std::string_view, const Entrant*> best;
    for (const Entrant& entrant : all)
      if (const auto column = column_of(*entrant.contestant); !column.empty()) best.try_emplace(column, &entrant);
    std::printf("| %s | %.0e | %s | %s | %s | %s | %s | %s | %s | %s | %s |\n", title, accuracies[i],
                choice_of(best, frames).c_str(), cell(best, frames).c_str(), choice_of(best, turns).c_str(),
                cell(best, turns).c_str(), cell(best, implicit).c_str(), cell(best, series).c_str(),
                cell(best, "measure").c_str(), ratio(best, frames).c_str(), ratio(best, turns).c_str());
  }
}

/// steps_of() returns the nanoseconds of a step of each request, the least of `times` runs that take turns.
std::vector<double> steps_of(std::vector<Request> requests, int times = 5) {
  constexpr std::int64_t steps = 100'000;
  std::vector<double> least(requests.size(), std::numeric_limits<double>::infinity());
  for (Request& request : requests) {
    request.until_steps = true;
    request.steps = steps;
    request.limits = {1e9, 1'000'000'000, 1'000'000};
  }
  for (int k = 0; k < times; ++k)
    for (std::size_t i = 0; i < requests.size(); ++i)
      least[i] = std::min(least[i], 1e9 * runs::go(requests[i]).outcome.cost.seconds / static_cast<double>(steps));
  return least;
}
double step_of(const lifted::Scene& of, const char* scheme) {
  Request request = lifted::request_of(of, texts::mechanics_of(of.definition), 0.001, 1, scheme);
  if (std::string_view(scheme) == implicit) runs::set(request, "stages", 1);
  return steps_of({request})[0];
}

/// The cost of a constant kinetic matrix that is not diagonal, for two coordinates.
void coupled_masses() {
  const auto leapfrog = [](const char* kinetic) {
    const std::string rest = " - 0.99/sqrt((x+0.01)^2 + y^2) - 0.01/sqrt((x-0.99)^2 + y^2)";
    const lifted::Scene scene{"", lifted::of(lifted::hamiltonian, {"x", "y"}, {}, kinetic + rest), {0.5, 0, 0, 1.2}};
    return lifted::request_of(scene, texts::mechanics_of(scene.definition), 0.001, 1, "leapfrog");
  };
  const auto ns = steps_of({leapfrog("px^2/2 + py^2"), leapfrog("px^2/2 + py^2 + px*py/3")}, 25);
  std::printf(
      "\nA step of `leapfrog` on two coordinates with a potential of two centres: %.1f ns with masses of their own, "
      "%.1f ns\nwith a kinetic matrix that is not diagonal, %.2f times as much; the goal is 1.1.\n",
      ns[0], ns[1], ns[1] / ns[0]);
}

/// lifted_splitting on the flows of the catalogue, against the splitting into the problem's own exact flows.
void flows() {
  std::printf(
      "\nFlows of the catalogue, by `lifted_splitting` on their rates and by `contact_splitting` on flows of their "
      "own: "
      "a step\nin nanoseconds, and the error at the end of 1000 steps of the suggested length.\n\n"
      "| problem | `lifted_splitting` | `contact_splitting` | error | error |\n|---|---|---|---|---|\n");
  for (const auto& problem : problem_list()) {
    const ProblemCard& card = problem->card();
    if (!runs::fits(card, find_scheme(frames).value()) || !is_wanted(card.id)) continue;
    Request truth = runs::defaults(card.id, series);
    runs::only_final(truth);
    std::vector<Request> both;
    std::vector<double> errors;
    for (const char* scheme : {frames, "contact_splitting"}) {
      Request& request = both.emplace_back(runs::defaults(card.id, scheme));
      runs::only_final(request);
      truth.end = request.end = request.scene->start + 1000 * request.setting("step", schemes()[request.scheme]);
      errors.push_back(0);
      const auto known = runs::go(truth).outcome.final, found = runs::go(request).outcome.final;
      for (std::size_t i = 0; i < known.size(); ++i)
        if (!std::isnan(known[i])) errors.back() = std::max(errors.back(), std::abs(found[i] - known[i]));
    }
    const auto ns = steps_of(both);
    std::printf("| `%s` | %.0f | %.0f | %.1e | %.1e |\n", card.id.c_str(), ns[0], ns[1], errors[0], errors[1]);
  }
}

}  // namespace

void bench::lifts() {
  bench::heading("Frames that turn, and magnetic fields");
  std::printf(
      "Microseconds of a run whose largest error at 64 times along it is at most so much, of scenes as text: by the\n"
      "fastest composition of `lifted_splitting`, of `boris` or `adaptive_boris`, which keep the volume alone, of\n"
      "`contact_gauss`, which keeps as much as the first, of `taylor`, and of the measures. The goal is at most three\n"
      "times what `taylor` needs at 1e-6.\n\n"
      "| scene | error | `lifted_splitting` | µs | `boris` | µs | `contact_gauss` | `taylor` | measures | lifted over "
      "`taylor` | boris over `taylor` |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|\n");
  const double turn = 2 * std::acos(-1.0);
  using namespace lifted;
  rows("restricted three bodies, 20 turns", {"", restricted_three_bodies(), {0.5, 0, 0, 1.2}}, 20 * turn);
  rows("Arenstorf's orbit, half a period",
       {"", restricted_three_bodies(), {0.994, 0, 0, 0.994 - 2.00158510637908252240}}, 17.0652165601579625588 / 2);
  rows("Howell's halo orbit, one period",
       {"", restricted_three_bodies_in_space(), {0.723268, 0, 0.04, 0, 0.723268 + 0.198019, 0}}, 2 * 1.300177);
  rows("charge in a dipole, t = 50", {"", charge_in_a_dipole(), {1, 0, 0, 0, 0.1, 0.05}}, 50);
  rows("charge in a uniform field, t = 100", {"", charge_in_a_uniform_field(), {1, 0.3, 0.2, 0.5}}, 100);
  rows("Foucault's pendulum, t = 100", {"", foucaults_pendulum(), {1, 0, 0, 0.2}}, 100);
  rows("friction not linear in s, t = 20", {"", contact_prototype(), {1, 0.5, 0.2}}, 20);

  std::printf(
      "\nA step in nanoseconds, of order 2 but for `runge_kutta_4`:\n\n| scene | scheme | ns |\n|---|---|---|\n");
  const lifted::Scene still{"",
                            of(hamiltonian, {"x", "y"}, {{"mu", 0.012277471}},
                               "(px^2 + py^2)/2 - (1-mu)/sqrt((x+mu)^2 + y^2) - mu/sqrt((x-1+mu)^2 + y^2)"),
                            {0.5, 0, 0, 1.2}},
      turning{"", restricted_three_bodies(), {0.5, 0, 0, 1.2}}, dipole{"", charge_in_a_dipole(), {1, 0, 0, 0, 1, 0.6}};
  std::printf("| two centres at rest | `leapfrog` | %.0f |\n", step_of(still, "leapfrog"));
  std::printf("| two centres at rest | `runge_kutta_4` | %.0f |\n", step_of(still, "runge_kutta_4"));
  for (const char* scheme : {frames, turns, implicit, "runge_kutta_4"}) {
    std::printf("| two centres, turning | `%s` | %.0f |\n", scheme, step_of(turning, scheme));
    std::printf("| charge in a dipole | `%s` | %.0f |\n", scheme, step_of(dipole, scheme));
  }
  coupled_masses();
  flows();
}
