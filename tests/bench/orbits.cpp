#include "tests/bench/orbits.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "core/problems/spin_orbit.hpp"
#include "core/state_error.hpp"
#include "tests/support/runs.hpp"

namespace {
const std::atomic<bool> never{false};
}  // namespace

using namespace least;

bench::TrueOrbit::TrueOrbit(const Request& of) : scene(of) {
  constexpr std::size_t count = 64;
  const auto always = [] { return true; };
  const auto known = conditioning(*scene.scene, scene.end, always);
  if (known->ends) scene.end = known->reached;
  for (std::size_t k = 1; k < count; ++k) times.push_back(known->pace[k * known->pace.size() / count]);
  times.push_back(scene.end);
  times.erase(std::unique(times.begin(), times.end()), times.end());
  truth = least::truth(*scene.scene, times, always);
  floor = std::max(truth->uncertainty, 0x1p-53 * known->most_growth);
}

double bench::TrueOrbit::error(std::span<const double> states) const {
  double most = states.size() == times.size() * variables() ? 0 : std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < times.size() && std::isfinite(most); ++i) {
    const double here = state_error(states.data() + i * variables(), truth->states[i], variables());
    if (!(here <= most)) most = here;
  }
  return most;
}

bench::Contestant bench::ours(const TrueOrbit& orbit, const SchemeConfig& choice) {
  const ResolutionParameter dial(schemes()[choice.scheme]);
  const auto request = [&orbit, choice, dial](double value) {
    Request made = orbit.scene;
    made.scheme = choice.scheme;
    made.settings = dial.at(choice, value).settings;
    made.columns.clear();
    made.limits = {most_seconds, most_forces, 1'000'000};
    runs::only_final(made);
    return made;
  };
  const auto measured = [&orbit, request](double value) -> Run {
    Request made = request(value);
    runs::at_times(made, orbit.times);
    for (std::size_t i = 1; i <= orbit.variables(); ++i) made.columns.push_back(i);
    Samples samples;
    const Solution outcome = made.scene->mechanics->run(made, samples, never);
    const bool whole = outcome.stop.reason == ReturnCode::completed;
    return {whole ? orbit.error(samples.values) : std::numeric_limits<double>::quiet_NaN(),
            outcome.cost.force_evaluations};
  };
  const auto prepared = [request](double value) -> std::function<void()> {
    return [made = request(value)] {
      Samples none;
      made.scene->mechanics->run(made, none, never);
    };
  };
  const SchemeCard& card = schemes()[choice.scheme];
  const std::string words = name(card, choice);
  double coarsest = dial.adaptive() ? dial.range.high : std::min(1e3 * dial.value(choice), dial.range.high);
  if (dial.name == "step") coarsest = std::min(coarsest, (orbit.scene.end - orbit.scene.scene->start) / 8);
  return {"`" + words.substr(0, card.id.size()) + "`" + words.substr(card.id.size()),
          coarsest,
          dial.adaptive() ? dial.range.low : std::max(1e-9 * coarsest, dial.range.low),
          dial.adaptive() ? std::pow(10, 0.25) : 1.1,
          measured,
          prepared,
          card.parameters[dial.index].symbol,
          card.id == "taylor"           ? Owner::taylor
          : card.id == "bulirsch_stoer" ? Owner::peer
                                        : Owner::structure,
          dial.name == "step" && orbit.scene.scene->card().id == "spin_orbit" ? problems::SpinOrbit<>{}.period() : 0};
}
