// Table of RESULTS.md: the scenes of the catalogue that are defined as text, by schemes that keep their structure, by
// `taylor` and by the schemes they are measured against. Printed before the benchmarks.
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "server/decode/scene_files.hpp"
#include "tests/bench/orbits.hpp"
#include "tests/bench/table.hpp"
#include "tests/support/texts.hpp"

namespace {

using namespace least;
using namespace bench;

constexpr double far = 30;  // a scheme that costs so many times as much as the cheapest is left out

std::string time_of(const std::map<Owner, const Entrant*>& best, Owner owner) {
  const auto found = best.find(owner);
  if (found == best.end()) return "–";
  char text[32];
  std::snprintf(text, sizeof text, found->second->us < 100 ? "%.1f" : "%.0f", found->second->us);
  return text;
}

/// rows() prints the rows of a scene, over its own span.
void rows(const std::shared_ptr<const Mechanics>& mechanics) {
  const ProblemCard& card = mechanics->card();
  if (!is_wanted(card.id)) return;
  const Progress told(card.id);
  std::vector<double> start;
  for (const auto& variable : card.variables)
    if (!variable.hidden) start.push_back(variable.value);
  const TrueOrbit orbit(texts::request_by("taylor", mechanics, start, card.span));
  std::vector<Ladder> ladders;
  for (const SchemeConfig& choice : catalogue_candidates(*orbit.scene.scene->mechanics, {})) {
    const SchemeCard& scheme = schemes()[choice.scheme];
    const bool form = scheme.structure == "symplectic" || scheme.structure == "contact";
    if (!form && !scheme.own_clock) continue;
    ladders.push_back({ours(orbit, choice)});
    ladders.back().contestant.owner = form ? Owner::structure : scheme.id == "taylor" ? Owner::taylor : Owner::peer;
  }
  std::size_t above = 0;
  while (above < accuracies.size() && accuracies[above] >= 3 * orbit.floor) ++above;
  char span[32];
  std::snprintf(span, sizeof span, "%.4g", orbit.scene.end - orbit.scene.scene->start);
  if (above == 0)
    std::printf("| %s | %s | nothing, as a start to the last digit says no more than %.0e | – | – | – | – |\n",
                card.id.c_str(), span, orbit.floor);
  if (above == 0) return;
  descend(ladders, above, far);
  for (std::size_t i = 1; i < above; i += 2) {
    std::vector<Entrant> all = entrants(ladders, i);
    race(all, 5);
    std::map<Owner, const Entrant*> best;
    for (const Entrant& entrant : all) best.try_emplace(entrant.contestant->owner, &entrant);
    char choice[160] = "–";
    if (const auto found = best.find(Owner::structure); found != best.end())
      std::snprintf(choice, sizeof choice, "%s, %s = %.3g", found->second->contestant->name.c_str(),
                    std::string(found->second->contestant->symbol).c_str(), found->second->value);
    std::printf("| %s | %s | %.0e | %s | %s | %s | %s |\n", card.id.c_str(), span, accuracies[i], choice,
                time_of(best, Owner::structure).c_str(), time_of(best, Owner::taylor).c_str(),
                time_of(best, Owner::peer).c_str());
  }
}

}  // namespace

void bench::scenes() {
  heading("Scenes of the catalogue that are data");
  std::printf(
      "Microseconds of a run whose largest error at 64 times along it is at most so much, over the span of the card: "
      "by\n"
      "the fastest scheme that keeps the structure, by `taylor`, and by the fastest of the measures.\n\n"
      "| scene | span | error | keeps structure | µs | `taylor` | measures |\n|---|---|---|---|---|---|---|\n");
  for (const server::TextProblem& problem : server::text_problems())
    if (problem.events.empty()) rows(problem.mechanics);  // errors here are those of motions without events that act
}
