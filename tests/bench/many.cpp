// A step of leapfrog for scenes of many bodies, typed as a sum over pairs, against loops over the pairs by hand.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/text/written_out.hpp"
#include "tests/bench/table.hpp"
#include "tests/support/texts.hpp"

namespace {

using namespace least;

constexpr double h = 1e-4, softening = 0.01;

/// start() returns coordinate i at the start; all bodies are at rest.
double start(std::size_t i) { return std::sin(7.3 * static_cast<double>(i)); }

std::shared_ptr<const Mechanics> scene(text::TypedScene typed) {
  const auto written = text::WrittenOut::of(std::move(typed));
  return texts::mechanics_of(std::get<text::WrittenOut>(written).definition());
}
/// V = −Σ 1/√(|r_i − r_j|² + .01), of bodies in space.
std::shared_ptr<const Mechanics> bodies(std::size_t count) {
  const std::string n = std::to_string(count);
  text::TypedScene typed;
  typed.scene.kind = text::Definition::Kind::potential;
  typed.scene.variables = {"x[" + n + "]", "y[" + n + "]", "z[" + n + "]"};
  typed.scene.formula =
      "-sum(i=1.." + n + ", j=i+1.." + n + ", 1/sqrt((x[i]-x[j])^2 + (y[i]-y[j])^2 + (z[i]-z[j])^2 + 0.01))";
  return scene(std::move(typed));
}
/// V = Σ u²/2 + u⁴/4 with u = q_{i+1} − q_i.
std::shared_ptr<const Mechanics> chain(std::size_t count) {
  const std::string n = std::to_string(count);
  text::TypedScene typed;
  typed.scene.kind = text::Definition::Kind::potential;
  typed.scene.variables = {"q[" + n + "]"};
  typed.scene.formula = "sum(i=1.." + n + "-1, (q[i+1]-q[i])^2/2 + (q[i+1]-q[i])^4/4)";
  return scene(std::move(typed));
}

/// The gradients of these potentials, by hand.
struct PairsByHand {
  std::size_t count;
  void operator()(const double* q, double* slope) const {
    const double *const x = q, *const y = q + count, *const z = q + 2 * count;
    std::fill_n(slope, 3 * count, 0.0);
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t j = i + 1; j < count; ++j) {
        const double dx = x[i] - x[j], dy = y[i] - y[j], dz = z[i] - z[j];
        const double square = dx * dx + dy * dy + dz * dz + softening;
        const double w = 1 / (square * std::sqrt(square));
        slope[i] += w * dx;
        slope[j] -= w * dx;
        slope[count + i] += w * dy;
        slope[count + j] -= w * dy;
        slope[2 * count + i] += w * dz;
        slope[2 * count + j] -= w * dz;
      }
  }
  std::size_t coordinates() const { return 3 * count; }
};
struct ChainByHand {
  std::size_t count;
  void operator()(const double* q, double* slope) const {
    std::fill_n(slope, count, 0.0);
    for (std::size_t i = 0; i + 1 < count; ++i) {
      const double u = q[i + 1] - q[i], f = u + u * u * u;
      slope[i] -= f;
      slope[i + 1] += f;
    }
  }
  std::size_t coordinates() const { return count; }
};

template <class Slopes>
[[gnu::noinline]] double by_hand(const Slopes& slopes, std::int64_t steps) {
  const std::size_t n = slopes.coordinates();
  std::vector<double> q(n), p(n, 0.0), slope(n);
  for (std::size_t i = 0; i < n; ++i) q[i] = start(i);
  slopes(q.data(), slope.data());
  for (std::int64_t k = 0; k < steps; ++k) {
    for (std::size_t i = 0; i < n; ++i) p[i] -= 0.5 * h * slope[i];
    for (std::size_t i = 0; i < n; ++i) q[i] += h * p[i];
    slopes(q.data(), slope.data());
    for (std::size_t i = 0; i < n; ++i) p[i] -= 0.5 * h * slope[i];
  }
  return q[1];
}

Request run_of(std::shared_ptr<const Mechanics> mechanics, std::int64_t steps) {
  Request request = runs::defaults("kepler", "leapfrog");
  runs::set(request, "step", h);
  Scene made{std::move(mechanics), {}, {}, 0};
  const ProblemCard& card = made.mechanics->card();
  for (std::size_t i = 0; i < card.variables.size(); ++i)
    made.initial.push_back(i < card.variables.size() / 2 ? start(i) : 0);
  request.scene = std::make_shared<const Scene>(std::move(made));
  request.until_steps = true;
  request.steps = steps;
  request.columns = {0};
  request.limits = {1e9, 1'000'000'000'000, 1'000'000};
  runs::only_final(request);
  return request;
}

template <class Slopes>
void row(const std::string& name, std::shared_ptr<const Mechanics> mechanics, const Slopes& slopes,
         std::int64_t steps) {
  const auto units = [steps](benchmark::State& state) { state.counters["units"] = static_cast<double>(steps); };
  const std::string text = "many/" + name, hand = "many by hand/" + name;
  benchmark::RegisterBenchmark(
      text.c_str(), [request = run_of(std::move(mechanics), steps), slopes, units](benchmark::State& state) {
        const double difference = runs::go(request).outcome.final.at(1) - by_hand(slopes, request.steps);
        if (!(std::abs(difference) < 1e-9)) state.SkipWithError("it is another motion");
        for (auto _ : state) benchmark::DoNotOptimize(runs::go(request));
        units(state);
      });
  benchmark::RegisterBenchmark(hand.c_str(), [slopes, steps, units](benchmark::State& state) {
    for (auto _ : state) benchmark::DoNotOptimize(by_hand(slopes, steps));
    units(state);
  });
  bench::compare(name + ", leapfrog: text, loop by hand", text, hand, 0);
}

const bool registered_many = [] {
  for (const std::size_t count : {6, 50, 100, 340})
    row(std::to_string(count) + " bodies", bodies(count), PairsByHand{count}, count == 6 ? 20'000 : 1'000);
  for (const std::size_t count : {100, 1000})
    row("a chain of " + std::to_string(count), chain(count), ChainByHand{count}, 1'000'000 / std::int64_t(count));
  return true;
}();

}  // namespace
