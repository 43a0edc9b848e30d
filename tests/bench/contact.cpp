// Contact schemes against loops written by hand, and the time that is saved by leaving out s and by tabulated phases.
#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "tests/bench/table.hpp"
#include "tests/support/runs.hpp"

namespace {

constexpr std::int64_t steps = 1'000'000;

// The same map as our contact_leapfrog with constant damping: one force, no exponential, no division.
[[gnu::noinline]] std::array<double, 2> damped_by_hand(double q, double p, double stiffness, double damping, double h,
                                                       std::int64_t n) {
  const double half = h / 2, before = 1 - half * damping, after = 1 / (1 + half * damping);
  double f = stiffness * q;
  for (std::int64_t i = 0; i < n; ++i) {
    const double v = before * p - half * f;
    q += h * v;
    f = stiffness * q;
    p = (v - half * f) * after;
  }
  return {q, p};
}
// The same map as our contact_splitting: one force, one sine and one exponential a step.
[[gnu::noinline]] std::array<double, 4> kepler_by_hand(double x, double y, double px, double py, double gamma,
                                                       double alpha, double frequency, double h, std::int64_t n) {
  const double half = h / 2;
  for (std::int64_t i = 0; i < n; ++i) {
    x += half * px;
    y += half * py;
    const double r2 = x * x + y * y, w = -gamma / (r2 * std::sqrt(r2)) * half;
    const double e = std::exp(-h * (alpha * std::sin(frequency * (static_cast<double>(i) * h + half))));
    px = e * (px - w * x) - w * x;
    py = e * (py - w * y) - w * y;
    x += half * px;
    y += half * py;
  }
  return {x, y, px, py};
}

least::Request bare(std::string_view problem, std::string_view scheme, double step) {
  least::Request request = runs::defaults(problem, scheme);
  request.until_steps = true;
  request.steps = steps;
  request.settings[0] = step;
  request.record.count = 0;
  request.limits.seconds = 1e9;
  return request;
}
/// with_action() asks for the column s, so that the run has to carry s.
least::Request with_action(least::Request request) {
  const auto& columns = request.scene->card().columns;
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (columns[i].name == "s") request.columns.push_back(i);
  return request;
}

void add(const std::string& name, std::function<void(benchmark::State&)> body) {
  benchmark::RegisterBenchmark(name.c_str(), std::move(body))->Unit(benchmark::kMillisecond);
}
void ours(const std::string& name, const least::Request& request) {
  add(name, [request](benchmark::State& state) {
    for (auto _ : state) {
      const auto result = runs::go(request);
      if (result.outcome.cost.steps != steps) state.SkipWithError("the run did not complete");
      benchmark::DoNotOptimize(result.outcome.final.data());
    }
    state.counters["units"] = steps;
  });
}

const bool registered = [] {
  add("hand/damped", [](benchmark::State& state) {
    double one = 1;
    benchmark::DoNotOptimize(one);
    for (auto _ : state) {
      auto end = damped_by_hand(-0.25, 0.75, one, 1e-6 * one, 0.01 * one, steps);
      benchmark::DoNotOptimize(end);
    }
    state.counters["units"] = steps;
  });
  add("hand/perturbed_kepler", [](benchmark::State& state) {
    double one = 1;
    benchmark::DoNotOptimize(one);
    for (auto _ : state) {
      auto end = kepler_by_hand(0.5, 0, 0, std::sqrt(3.0), -one, 0.01 * one, std::acos(-1.0) * one, 0.01 * one, steps);
      benchmark::DoNotOptimize(end);
    }
    state.counters["units"] = steps;
  });
  least::Request damped = bare("damped_oscillator", "contact_leapfrog", 0.01);
  runs::scene(damped).parameters[1] = 1e-6;  // weak damping, so that the motion does not decay to subnormal numbers
  ours("contact/damped", damped);
  ours("contact/damped with s", with_action(damped));
  bench::compare("contact_leapfrog damped_oscillator, by hand", "contact/damped", "hand/damped", 1.05);
  bench::compare("… with s, without", "contact/damped with s", "contact/damped", 0);

  const least::Request kepler = bare("perturbed_kepler", "contact_splitting", 0.01);
  ours("contact/perturbed_kepler", kepler);
  ours("contact/perturbed_kepler with s", with_action(kepler));
  bench::compare("contact_splitting perturbed_kepler, by hand", "contact/perturbed_kepler", "hand/perturbed_kepler",
                 1.05);
  bench::compare("… with s, without", "contact/perturbed_kepler with s", "contact/perturbed_kepler", 0);

  const double pi = std::acos(-1.0);
  for (const std::string scheme : {"contact_splitting", "contact_leapfrog"}) {
    ours("tabulated/" + scheme, bare("spin_orbit", scheme, pi / 10));
    ours("computed/" + scheme, bare("spin_orbit", scheme, 0.3141));
    bench::compare(scheme + " spin_orbit, h = π/10, h = .3141", "tabulated/" + scheme, "computed/" + scheme, 0);
  }
  // Steps that adapt to the force, with constant damping and with damping that changes in time, which makes the time
  // one more equation of each part.
  for (const std::string problem : {"damped_kepler", "perturbed_kepler"})
    for (const std::string composition : {"none", "kahan_li_8"}) {
      least::Request request = bare(problem, "time_transformed", composition == "none" ? 0.015 : 0.2);
      runs::set(request, "kappa", std::numeric_limits<double>::quiet_NaN());
      runs::set(request, "composition", composition);
      request.steps = 20'000;
      if (problem == "damped_kepler") runs::set(request, "alpha", 1e-6);  // weak, so that the orbit does not decay
      const std::string name = "transformed/" + problem + " " + composition;
      add(name, [request](benchmark::State& state) {
        std::int64_t forces = 0;
        for (auto _ : state) {
          const auto result = runs::go(request);
          if (result.outcome.cost.steps != request.steps) state.SkipWithError("the run did not complete");
          forces = result.outcome.cost.force_evaluations;
        }
        state.counters["units"] = static_cast<double>(forces);
      });
      bench::compare("time_transformed " + problem + ", " + composition + ", a force; leapfrog kepler", name,
                     "step/kepler", problem == "damped_kepler" && composition != "none" ? 33 / 16.0 : 0);
    }
  return true;
}();

}  // namespace
