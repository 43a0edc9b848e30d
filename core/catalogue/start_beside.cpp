#include "core/catalogue/start_beside.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/run/request.hpp"
#include "core/text/scene.hpp"

namespace least {
namespace {

/// Distances from the start, relative to a coordinate, or absolute if it is 0. For a moving start one in the twelfth
/// digit; a start at rest may be on top of something and would fall from there, so its distance is far smaller.
constexpr double very_close = 1e-12, next_to_rest = 1e-60;

/// Discards the rows of a run: its final state is what counts.
class NoRows final : public RowSink {
 public:
  bool append(std::span<const double>) override { return true; }
};

double moved(double x, double share) { return x + share * (x != 0 ? std::abs(x) : 1); }

bool is_regular(const Scene& scene) {
  return !scene.mechanics->text()->objection_to_start(scene.parameters, scene.start, scene.initial);
}

/// looks_at returns the number of starts that may be tried: each one writes the formulas anew, so that scenes of many
/// bodies get few.
std::size_t looks_at(const Scene& scene) {
  constexpr std::size_t most_operations = 60'000;  // together: about a tenth of a second
  const auto operations = static_cast<std::size_t>(scene.mechanics->text()->form->tape.size());
  return std::max<std::size_t>(most_operations / (operations + 1), 2);
}

/// short_run returns an accurate short run; empty if it fails.
std::optional<Solution> short_run(const Scene& scene, double end, std::int64_t most_steps) {
  const auto schemes = scene.mechanics->schemes();
  const auto scheme = std::ranges::find(schemes, "dormand_prince_5", &SchemeCard::id);
  if (scheme == schemes.end()) return std::nullopt;
  Request request;
  request.scene = std::make_shared<Scene>(scene);
  request.scheme = static_cast<std::size_t>(scheme - schemes.begin());
  for (const auto& setting : scheme->parameters)
    request.settings.push_back(setting.name == "tolerance" ? very_close : setting.value);
  request.end = end;
  request.columns = {0};
  request.record = {Record::Mode::every, 0, {}};
  request.limits.steps = most_steps;
  request.limits.seconds = 1;
  request.probe = true;
  NoRows rows;
  const std::atomic<bool> never{false};
  Solution solution = scene.mechanics->run(request, rows, never);
  const ReturnCode reason = solution.stop.reason;
  if (reason == ReturnCode::completed || (reason == ReturnCode::step_limit && solution.t > scene.start))
    return solution;
  return std::nullopt;
}

/// apart returns the largest difference of two states, relative to the largest component of either.
double apart(const std::vector<double>& x, const std::vector<double>& y) {
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (std::isnan(x[i]) && std::isnan(y[i])) continue;  // s, if the motion does not need it
    if (!std::isfinite(x[i] - y[i])) return INFINITY;
    difference = std::max(difference, std::abs(x[i] - y[i]));
    size = std::max({size, std::abs(x[i]), std::abs(y[i])});
  }
  return difference > 0 ? difference / size : 0;
}

/// beside returns the scene with these coordinates moved by this relative distance.
Scene beside(const Scene& scene, const std::vector<std::size_t>& coordinates, double share) {
  Scene other = scene;
  for (const std::size_t i : coordinates) other.initial[i] = moved(other.initial[i], share);
  return other;
}

/// has_limit returns whether the motions from both sides of the start and from another distance are the same.
bool has_limit(const Scene& scene, const std::vector<std::size_t>& coordinates, double share) {
  constexpr std::int64_t few_steps = 60, enough_steps = 2000;
  constexpr double same = 1e-8, visible = 1e-6;
  const Scene one = beside(scene, coordinates, share);
  if (!is_regular(one)) return false;
  const auto first = short_run(one, scene.start + scene.card().span, few_steps);
  if (!first) return false;
  if (share == next_to_rest) {
    // The scene is at rest if the tiny distance does not become visible within the whole motion.
    for (std::size_t i = 0; i < scene.initial.size(); ++i)
      if (std::abs(first->final[i] - one.initial[i]) > 1e-30) return false;
    return is_regular(beside(scene, coordinates, -share));
  }
  // Next to a pole steps are so short that the motion may not yet have become long enough to tell two motions apart.
  if (first->stop.reason != ReturnCode::completed && apart(first->final, one.initial) < visible) return false;
  for (const double other : {-1.0, 3.0}) {
    const Scene elsewhere = beside(scene, coordinates, other * share);
    if (!is_regular(elsewhere)) return false;
    const auto second = short_run(elsewhere, first->t, enough_steps);
    if (!second || second->stop.reason != ReturnCode::completed) return false;
    if (!(apart(first->final, second->final) < same)) return false;
  }
  return true;
}

}  // namespace

std::optional<std::vector<double>> start_beside(const Scene& scene) {
  const std::size_t n = scene.mechanics->text()->form->coordinates;
  std::vector<std::vector<std::size_t>> choices;  // one coordinate, or all if several poles meet
  std::vector<std::size_t> all(n);
  std::iota(all.begin(), all.end(), std::size_t{0});
  const std::size_t alone = std::min(n, looks_at(scene) / 2);
  for (std::size_t i = 0; i < alone; ++i) choices.push_back({i});
  if (n > 1) choices.push_back(all);
  for (const double share : {next_to_rest, very_close})
    for (const auto& coordinates : choices)
      if (has_limit(scene, coordinates, share)) return beside(scene, coordinates, share).initial;
  return std::nullopt;
}

std::string advice_on_start(const Scene& scene) {
  constexpr double visible = 1e-3;
  const text::TextScene& text = *scene.mechanics->text();
  const std::size_t looks = std::min(text.form->coordinates, looks_at(scene));
  for (std::size_t i = 0; i < looks; ++i) {
    const Scene other = beside(scene, {i}, visible);
    if (is_regular(other))
      return fmt::format("beside it, at {} = {:.6g}, it is regular: start there, with what the motion has there",
                         text.definition.variables[i], other.initial[i]);
  }
  Scene later = scene;
  later.start = moved(scene.start, visible);
  if (is_regular(later))
    return fmt::format(
        "a little later, at t = {:.6g}, it is regular: start there, with the first terms of the series of the solution",
        later.start);
  return {};
}

std::optional<std::vector<double>> regular_start(const Scene& scene) {
  constexpr std::size_t most_alone = 4;
  const text::TextScene& text = *scene.mechanics->text();
  const std::size_t n = text.form->coordinates, looks = looks_at(scene);
  const auto found = [&](auto&& place) {
    Scene other = scene;
    std::fill(other.initial.begin(), other.initial.end(), 0.0);
    for (std::size_t i = 0; i < n; ++i) other.initial[i] = place(i);
    const std::vector<double> start(other.initial.begin(), other.initial.begin() + static_cast<std::ptrdiff_t>(n));
    if (text.takes_velocities()) text.velocities_to_momenta(scene.parameters, scene.start, other.initial);
    return is_regular(other) ? std::optional(start) : std::nullopt;
  };
  auto start = found([](std::size_t) { return 0.0; });
  for (std::size_t one = 0; !start && one < std::min({n, most_alone, looks}); ++one)
    start = found([one](std::size_t i) { return i == one ? 1.0 : 0.0; });
  return start ? start : found([](std::size_t i) { return static_cast<double>(i + 1); });
}

}  // namespace least
