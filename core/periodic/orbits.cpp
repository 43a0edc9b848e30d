#include "core/periodic/orbits.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/periodic/stability.hpp"

namespace least::periodic {

std::variant<Motion::Equations, std::string> equations_of(const Scene& scene, std::optional<std::size_t> varied) {
  std::vector<bool> marked(scene.card().parameters.size(), false);
  if (varied) marked[*varied] = true;
  return variations::parametric_scene(scene, marked);
}

std::vector<double> components_of(const variations::ParametricScene& equations, const Scene& scene) {
  std::vector<double> x;
  x.reserve(equations.components);
  for (const std::size_t place : equations.variables) x.push_back(scene.initial[place]);
  return x;
}

std::shared_ptr<const Scene> scene_at(const Setting& setting, const variations::ParametricScene& equations,
                                      const Trial& trial) {
  auto scene = std::make_shared<Scene>(*setting.scene);
  if (setting.varied) scene->parameters[*setting.varied] = trial.value;
  for (std::size_t i = 0; i < equations.components; ++i) scene->initial[equations.variables[i]] = trial.nodes[0][i];
  const auto& variables = scene->card().variables;
  // Variables that follow from the others are not copied from the guess
  for (std::size_t i = 0; i < variables.size(); ++i)
    if (std::isnan(variables[i].value)) scene->initial[i] = variables[i].value;
  return scene;
}

std::vector<double> extents_of(Motion& motion, const Trial& trial, double start, Effort& effort, std::string& reason) {
  constexpr std::size_t looks = 256;
  const std::size_t size = motion.size(), n = motion.coordinates(), count = trial.nodes.size();
  std::vector<double> least = trial.nodes[0], most = least;
  for (std::size_t i = 0; i < count; ++i) {
    const double to = i + 1 < count ? trial.at[i + 1] : 1;
    std::vector<double> times(looks / count + 2);
    for (std::size_t k = 0; k < times.size(); ++k)
      times[k] = start + trial.period * (trial.at[i] + (to - trial.at[i]) * double(k + 1) / double(times.size()));
    const auto states = motion.path(trial.nodes[i], start + trial.period * trial.at[i], times, effort, reason);
    if (states.size() < times.size()) return {};
    for (const auto& state : states)
      for (std::size_t a = 0; a < size; ++a) {
        least[a] = std::min(least[a], state[a]);
        most[a] = std::max(most[a], state[a]);
      }
  }
  const auto kind = [n](std::size_t a) { return n == 0 ? 0 : a / n; };
  std::vector<double> extents(size);
  for (std::size_t a = 0; a < size; ++a)
    for (std::size_t b = 0; b < size; ++b)
      if (kind(a) == kind(b)) extents[a] = std::max(extents[a], most[b] - least[b]);
  return extents;
}

bool repeats(const Rates& a, const Rates& b, std::span<const double> x, double t, double dt, double later) {
  constexpr int looks = 8;
  constexpr double same = 1e-8;
  Spread spread;
  double most = 0, size = 0;
  for (int look = 0; look < looks; ++look) {
    std::vector<double> place(x.begin(), x.end());
    for (double& part : place) part += 0.1 * spread() * std::max(std::abs(part), 0.1);
    const double at = t + dt * std::abs(spread());
    const auto here = a(place, at), there = b(place, at + later);
    for (std::size_t i = 0; i < here.size(); ++i) {
      if (!std::isfinite(here[i]) || !std::isfinite(there[i])) continue;
      most = std::max(most, std::abs(here[i] - there[i]));
      size = std::max(size, std::abs(here[i]));
    }
  }
  return most <= same * size;
}

std::optional<std::vector<bool>> reversed_components(const Rates& rates, std::span<const double> x, double t,
                                                     std::size_t coordinates) {
  std::vector<std::size_t> zero;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (x[i] == 0) zero.push_back(i);
  constexpr std::size_t most_zeros = 12;
  if (zero.size() > most_zeros) return std::nullopt;
  const auto holds = [&](const std::vector<bool>& minus) {
    Spread spread;
    constexpr int looks = 6;
    constexpr double same = 1e-9;
    for (int look = 0; look < looks; ++look) {
      std::vector<double> place(x.begin(), x.end());
      for (double& part : place) part += 0.1 * spread() * std::max(std::abs(part), 0.1);
      std::vector<double> mirrored = place;
      for (std::size_t i = 0; i < mirrored.size(); ++i)
        if (minus[i]) mirrored[i] = -mirrored[i];
      const auto here = rates(place, t), there = rates(mirrored, t);
      double size = 0;
      for (const double rate : here) size = std::max(size, std::abs(rate));
      for (std::size_t i = 0; i < here.size(); ++i)
        if (std::abs(there[i] + (minus[i] ? -here[i] : here[i])) > same * size) return false;
    }
    return true;
  };
  for (unsigned set = (1U << zero.size()) - 1; set > 0; --set) {
    std::vector<bool> minus(x.size(), false);
    std::size_t count = 0;
    for (std::size_t k = 0; k < zero.size(); ++k)
      if ((set >> k & 1U) != 0) {
        minus[zero[k]] = true;
        ++count;
      }
    if ((coordinates == 0 || count == coordinates) && holds(minus)) return minus;
  }
  return std::nullopt;
}

bool close_half(Motion& motion, const Setting& setting, const std::vector<bool>& minus, Trial& trial, Effort& effort,
                int& iterations, std::string& reason) {
  constexpr double longest = 0.3, round_off = 1e-13;
  constexpr int most_halves = 8, most_rounds = 60;
  const std::size_t n = motion.size();
  const auto seen_from = [&](const Trial& at) {
    return motion.follow(at.nodes[0], setting.start(), at.period / 2, effort, reason);
  };
  const auto missing = [&](const Reached& reached) {
    std::vector<double> values;
    values.reserve(n);
    for (std::size_t i = 0; i < n; ++i)
      if (minus[i]) values.push_back(reached.state[i] / setting.extents[i]);
    return values;
  };
  auto seen = seen_from(trial);
  if (!seen) return false;
  for (iterations = 0; iterations < most_rounds; ++iterations) {
    std::vector<double> right = missing(*seen);
    const double size = length(right);
    if (size <= round_off) return true;
    const auto ends = motion.rates(seen->state, setting.start() + trial.period / 2);
    Matrix rows(0, n + 1);
    for (std::size_t i = 0; i < n; ++i) {
      if (!minus[i]) continue;
      for (std::size_t j = 0; j < n; ++j)
        rows.a.push_back(minus[j] || setting.fixed[j] ? 0
                                                      : seen->by_start(i, j) * setting.extents[j] / setting.extents[i]);
      rows.a.push_back(ends[i] / 2 * setting.guess_period / setting.extents[i]);
      ++rows.rows;
    }
    for (double& part : right) part = -part;
    constexpr double least_pivot = 1e-11;
    const std::vector<double> change = decompose(rows, right, least_pivot).solution;
    double most = 0;
    for (const double part : change) most = std::max(most, std::abs(part));
    if (!std::isfinite(most)) break;
    std::optional<Reached> better;
    Trial tried;
    double share = most > longest ? longest / most : 1;
    for (int half = 0; half < most_halves && !better; ++half, share /= 2) {
      tried = trial;
      for (std::size_t j = 0; j < n; ++j) tried.nodes[0][j] += share * change[j] * setting.extents[j];
      tried.period += share * change[n] * setting.guess_period;
      if (!(tried.period > 0)) continue;
      better = seen_from(tried);
      if (effort.over()) return false;
      if (better && !(length(missing(*better)) < size)) better.reset();
    }
    if (!better) {
      if (size <= Shooting::close_enough) return true;
      break;
    }
    trial = std::move(tried);
    seen = std::move(better);
  }
  reason = "no second crossing at right angles was found";
  return false;
}

double nearest_return(Motion& motion, const Setting& setting, const Trial& guess, Effort& effort) {
  constexpr double by_far = 0.5;
  constexpr std::size_t looks = 512;
  constexpr int rounds = 3;  // each zooms in on the minimum of the last one
  double nearest = std::numeric_limits<double>::infinity(), found = guess.period;
  const auto look = [&](const std::vector<double>& times) {
    std::string reason;
    const auto states = motion.path(guess.nodes[0], setting.start(), times, effort, reason);
    for (std::size_t k = 0; k < states.size(); ++k) {
      std::vector<double> away(states[k].size());
      for (std::size_t i = 0; i < away.size(); ++i)
        away[i] = (states[k][i] - guess.nodes[0][i] - setting.turns[i]) / setting.extents[i];
      if (const double distance = length(away); distance < nearest) {
        nearest = distance;
        found = times[k] - setting.start();
      }
    }
  };
  look({setting.start() + guess.period});
  const double at_guess = nearest;
  double from = 0.6 * guess.period, to = 1.5 * guess.period;
  for (int round = 0; round < rounds; ++round) {
    std::vector<double> times(looks);
    for (std::size_t k = 0; k < looks; ++k)
      times[k] = setting.start() + from + (to - from) * double(k) / double(looks - 1);
    look(times);
    const double close = 2 * (to - from) / double(looks - 1);
    from = found - close;
    to = found + close;
  }
  return nearest < by_far * at_guess ? found : guess.period;
}

Orbit orbit_of(Shooting& shooting, const Setting& setting, const Trial& trial, const Look& look, Effort& effort) {
  Motion& motion = shooting.prepare(trial);
  const variations::ParametricScene& equations = motion.equations();
  Orbit made;
  made.scene = scene_at(setting, equations, trial);
  made.period = trial.period;
  made.segments = trial.nodes.size();
  made.closure = look.closure;
  if (shooting.conserved().keeps_energy()) made.energy = motion.energy(trial.nodes[0], setting.start());
  made.invariants = shooting.conserved().declared(trial.nodes[0], setting.start());
  for (const std::size_t place : equations.variables) made.rows.push_back(setting.scene->card().variables[place].name);
  made.monodromy = Matrix::identity(motion.size());
  for (const Reached& segment : look.segments) made.monodromy = segment.by_start * made.monodromy;
  if (look.closure <= Shooting::close_enough)
    made.stability = stability_of(shooting, motion, setting, trial, look, effort);
  return made;
}

}  // namespace least::periodic
