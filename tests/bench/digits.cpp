// Table of the README: what a digit costs, for our best scheme and for those of other libraries. Printed before the
// benchmarks.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/state_error.hpp"
#include "core/study/error_study.hpp"
#include "tests/bench/peers.hpp"
#include "tests/bench/table.hpp"
#include "tests/support/runs.hpp"

namespace {

using namespace least;

constexpr std::array accuracies{1e-4, 1e-6, 1e-8, 1e-10};
constexpr std::int64_t most_forces = 2'000'000;  // of a run
const std::atomic<bool> never{false};
constexpr std::string_view taylor = "`taylor`";

/// A scene with its true states at 64 times that follow the motion, dense where that is fast. The last is the end.
struct TrueOrbit {
  Request scene;  ///< up to where the motion goes
  std::vector<double> times;
  std::shared_ptr<const Truth> truth;
  double floor;  ///< errors below mean nothing

  explicit TrueOrbit(const Request& of) : scene(of) {
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

  std::size_t variables() const { return truth->states.front().size(); }
  /// The largest of all times, of states in a row; not finite where one is not, or missing.
  double error(std::span<const double> states) const {
    double most = states.size() == times.size() * variables() ? 0 : std::numeric_limits<double>::quiet_NaN();
    for (std::size_t i = 0; i < times.size() && std::isfinite(most); ++i) {
      const double here = state_error(states.data() + i * variables(), truth->states[i], variables());
      if (!(here <= most)) most = here;
    }
    return most;
  }
};

struct Run {
  double error;  ///< NaN where it did not complete
  std::int64_t forces;
};

/// A scheme with a setting that makes it as fine as one likes.
struct Contestant {
  std::string name;
  double coarsest, finest, finer;  ///< the setting: where to begin and to end, the factor between two
  std::function<Run(double)> measured;
  std::function<std::function<void()>(double)> prepared;  ///< a run as one would make it, straight to the end
  std::string_view symbol{};                              ///< of the setting; empty: no scheme of ours
};

Contestant ours(const TrueOrbit& orbit, const SchemeConfig& choice) {
  const ResolutionParameter dial(schemes()[choice.scheme]);
  const auto request = [&orbit, choice, dial](double value) {
    Request made = orbit.scene;
    made.scheme = choice.scheme;
    made.settings = dial.at(choice, value).settings;
    made.columns.clear();
    made.limits = {10, most_forces, 1'000'000};
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
  const double coarsest = dial.adaptive() ? dial.range.high : std::min(1e3 * dial.value(choice), dial.range.high);
  return {"`" + words.substr(0, card.id.size()) + "`" + words.substr(card.id.size()),
          coarsest,
          dial.adaptive() ? dial.range.low : std::max(1e-9 * coarsest, dial.range.low),
          dial.adaptive() ? std::pow(10, 0.25) : 1.1,
          measured,
          prepared,
          card.parameters[dial.index].symbol};
}

Contestant theirs(const TrueOrbit& orbit, const bench::Peer& peer) {
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
  return {std::string(peer.name), 1, 1e-16, std::pow(10, 0.25), measured, prepared};
}

/// The coarsest setting of a contestant at which it reaches each accuracy, and at the next finer one, too: in the noise
/// of round-off, and where an error happens to change its sign, single runs are better than the rest.
struct Ladder {
  struct Rung {
    double value;
    std::int64_t forces;
    bool holds = false;
  };
  Contestant contestant;
  double value = contestant.coarsest;
  std::int64_t cost = 0;  ///< of a run, so far, in force evaluations
  std::array<std::optional<Rung>, accuracies.size()> rungs{};

  const Rung* reached(std::size_t accuracy) const {
    const auto& rung = rungs[accuracy];
    return rung && rung->holds ? &*rung : nullptr;
  }
  void descend() {
    const Run run = contestant.measured(value);
    cost = std::max(cost, run.forces);
    for (std::size_t i = 0; i < accuracies.size(); ++i) {
      auto& rung = rungs[i];
      if (reached(i)) continue;
      if (!(run.error <= accuracies[i]))
        rung.reset();
      else if (rung)
        rung->holds = true;
      else
        rung = {value, run.forces};
    }
    value /= contestant.finer;
  }
};

/// All ladders side by side, the cheapest next run first, until what is left is `far` times as dear as the cheapest run
/// that has the first `count` accuracies.
void descend(std::vector<Ladder>& ladders, std::size_t count, double far) {
  double most = most_forces;
  while (true) {
    Ladder* next = nullptr;
    for (Ladder& ladder : ladders)
      if (!ladder.reached(count - 1) && ladder.value > ladder.contestant.finest && (!next || ladder.cost < next->cost))
        next = &ladder;
    if (!next || static_cast<double>(next->cost) > most) return;
    next->descend();
    if (const auto* last = next->reached(count - 1)) most = std::min(most, far * static_cast<double>(last->forces));
  }
}

/// Of each the smallest of interleaved repetitions.
std::vector<double> microseconds(const std::vector<std::function<void()>>& all, int rounds) {
  using Clock = std::chrono::steady_clock;
  constexpr double batch = 50;  // runs shorter than this are made several times in a row
  std::vector<double> least(all.size(), std::numeric_limits<double>::infinity());
  for (int round = 0; round < rounds; ++round)
    for (std::size_t i = 0; i < all.size(); ++i) {
      const int repeats = static_cast<int>(std::clamp(batch / least[i], 1.0, 1e3));  // at first once
      const auto start = Clock::now();
      for (int k = 0; k < repeats; ++k) all[i]();
      const double together = std::chrono::duration<double, std::micro>(Clock::now() - start).count();
      least[i] = std::min(least[i], together / repeats);
    }
  return least;
}

/// A contestant at the coarsest setting that will do.
struct Entrant {
  const Contestant* contestant;
  double value;
  std::int64_t forces;
  double us = std::numeric_limits<double>::infinity();
};

std::vector<Entrant> entrants(const std::vector<Ladder>& ladders, std::size_t accuracy) {
  std::vector<Entrant> all;
  for (const Ladder& ladder : ladders)
    if (const auto* rung = ladder.reached(accuracy)) all.push_back({&ladder.contestant, rung->value, rung->forces});
  return all;
}

void race(std::vector<Entrant>& all, int rounds) {
  std::vector<std::function<void()>> runs;
  for (const Entrant& entrant : all) runs.push_back(entrant.contestant->prepared(entrant.value));
  const auto us = microseconds(runs, rounds);
  for (std::size_t i = 0; i < all.size(); ++i) all[i].us = us[i];
  std::ranges::stable_sort(all, {}, &Entrant::us);
}

std::string time_of(const Entrant* entrant) {
  char text[32] = "–";
  if (entrant) std::snprintf(text, sizeof text, entrant->us < 100 ? "%.1f" : "%.0f", entrant->us);
  return text;
}
std::string forces_of(const Entrant* entrant) { return entrant ? std::to_string(entrant->forces) : "–"; }

void row(const char* title, std::size_t accuracy, const std::vector<Ladder>& our, const std::vector<Ladder>& their) {
  std::vector<Entrant> all = entrants(our, accuracy), peers = entrants(their, accuracy);
  race(all, 3);
  // The slower ones are out, but for the one that has a column of its own.
  for (std::size_t i = all.size(); i-- > 5;)
    if (all[i].contestant->name != taylor) all.erase(all.begin() + static_cast<std::ptrdiff_t>(i));
  all.insert(all.end(), peers.begin(), peers.end());
  race(all, 15);
  const auto first = [&](auto&& fits) {
    const auto found = std::ranges::find_if(all, fits);
    return found == all.end() ? nullptr : &*found;
  };
  const auto called = [&](std::string_view name) {
    return first([&](const Entrant& entrant) { return entrant.contestant->name == name; });
  };
  const auto is_ours = [](const Entrant& entrant) { return !entrant.contestant->symbol.empty(); };
  const Entrant *ours = first(is_ours), *peer = first(std::not_fn(is_ours));
  char choice[160] = "–", ratio[32] = "–";
  if (ours)
    std::snprintf(choice, sizeof choice, "%s, %s = %.3g", ours->contestant->name.c_str(),
                  std::string(ours->contestant->symbol).c_str(), ours->value);
  if (ours && peer) std::snprintf(ratio, sizeof ratio, "%.2f", peer->us / ours->us);
  const Entrant* fehlberg = called("fehlberg_78");
  std::printf("| %s | %.0e | %s | %s | %s | %s | %s | %s | %s | %s | %s |\n", title, accuracies[accuracy], choice,
              forces_of(ours).c_str(), time_of(ours).c_str(), time_of(called(taylor)).c_str(),
              forces_of(fehlberg).c_str(), time_of(fehlberg).c_str(), time_of(called("dormand_prince_5")).c_str(),
              time_of(called("rk8pd")).c_str(), ratio);
}

/// What others have made is a measure of ours, also where it stands in the catalogue.
bool is_baseline(const SchemeConfig& choice) {
  const std::string_view id = schemes()[choice.scheme].id;
  return id == "dormand_prince_5" || id == "fehlberg_78" || id == "bulirsch_stoer";
}

void rows(const char* title, const Request& scene) {
  const TrueOrbit orbit(scene);
  std::size_t above = 0;
  while (above < accuracies.size() && accuracies[above] >= 3 * orbit.floor) ++above;
  std::vector<Ladder> our, their;
  for (const SchemeConfig& choice : candidates(*scene.scene->mechanics, {}))
    if (!is_baseline(choice)) our.push_back({ours(orbit, choice)});
  for (const bench::Peer& peer : bench::peers(orbit.scene)) their.push_back({theirs(orbit, peer)});
  if (above > 0) {
    descend(our, above, 5);
    descend(their, above, std::numeric_limits<double>::infinity());
  }
  for (std::size_t i = 0; i < above; ++i) row(title, i, our, their);
  for (std::size_t i = above; i < accuracies.size(); ++i)
    std::printf("| %s | %.0e | below the floor, %.0e | – | – | – | – | – | – | – | – |\n", title, accuracies[i],
                orbit.floor);
}

/// From its default start, up to `end`; the scheme in it is any that fits.
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
      "Force evaluations and time of a run whose largest error at 64 times along it is at most so much, by our "
      "fastest\n"
      "scheme and by those of Boost.Odeint and GSL, each at the coarsest setting that reaches it and keeps it when\n"
      "refined. –: reached at none.\n\n"
      "| scene | error | ours | forces | µs | `taylor`: µs | `fehlberg_78`: forces | µs | `dormand_prince_5`: µs | GSL "
      "rk8pd: µs | "
      "best peer / ours |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
  const double pi = std::acos(-1.0);
  Request round = scene("kepler", 200 * pi);
  runs::scene(round).initial = {0.4, 0, 0, 2};
  rows("Kepler, e = 0.6, 100 periods", round);
  rows("Kepler, e = 0.961, 10 periods", scene("kepler", 10 * 18.893743377439769));
  rows("damped oscillator, t = 100", scene("damped_oscillator", 100));
  rows("perturbed Kepler, e = 0.5, t = 50", scene("perturbed_kepler", 0));
  Request eccentric = scene("perturbed_kepler", 0);
  runs::scene(eccentric).initial = {0.1, 0, 0, std::sqrt(19.0), 0};
  rows("perturbed Kepler, e = 0.9, t = 50", eccentric);
  rows("damped Kepler, e = 0.9, t = 60", scene("damped_kepler", 0));
  rows("Lane–Emden, n = 3, to its surface", scene("lane_emden", 0));
  Request relaxation = scene("van_der_pol", 100);
  runs::set(relaxation, "epsilon", 10);
  rows("van der Pol, ε = 10, t = 100", relaxation);
  rows("spin–orbit, 100 periods", scene("spin_orbit", 200 * pi));
  rows("pendulum, 100 periods", scene("pendulum", 200 * pi));
  rows("Hénon–Heiles, t = 100", scene("henon_heiles", 100));
  rows("driven oscillator", scene("driven_oscillator", 0));
  rows("scalar-field cosmology", scene("scalar_field_cosmology", 0));
}
