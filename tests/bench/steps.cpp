// A step of ours against a loop written by hand, and against Boost.Odeint's velocity_verlet.
#include <benchmark/benchmark.h>

#include <array>
#include <boost/numeric/odeint/stepper/velocity_verlet.hpp>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <string>
#include <utility>

#include "tests/bench/table.hpp"
#include "tests/support/runs.hpp"

namespace {

constexpr std::int64_t steps = 1'000'000;
constexpr double h = 0.01;

// The same map as our leapfrog: kick, drift, kick, with the force re-used from step to step.
[[gnu::noinline]] std::array<double, 2> harmonic_by_hand(double q, double p, double mass, double stiffness,
                                                         std::int64_t n) {
  const double half = h / 2, rate = h / mass;
  double f = stiffness * q;
  for (std::int64_t i = 0; i < n; ++i) {
    p -= half * f;
    q += rate * p;
    f = stiffness * q;
    p -= half * f;
  }
  return {q, p};
}
[[gnu::noinline]] std::array<double, 2> pendulum_by_hand(double q, double p, double gravity, double length,
                                                         std::int64_t n) {
  const double half = h / 2, w = gravity / length;
  double f = w * std::sin(q);
  for (std::int64_t i = 0; i < n; ++i) {
    p -= half * f;
    q += h * p;
    f = w * std::sin(q);
    p -= half * f;
  }
  return {q, p};
}
[[gnu::noinline]] std::array<double, 4> kepler_by_hand(double x, double y, double px, double py, double mu,
                                                       std::int64_t n) {
  const double half = h / 2;
  double r2 = x * x + y * y, w = mu / (r2 * std::sqrt(r2)), fx = w * x, fy = w * y;
  for (std::int64_t i = 0; i < n; ++i) {
    px -= half * fx;
    py -= half * fy;
    x += h * px;
    y += h * py;
    r2 = x * x + y * y;
    w = mu / (r2 * std::sqrt(r2));
    fx = w * x;
    fy = w * y;
    px -= half * fx;
    py -= half * fy;
  }
  return {x, y, px, py};
}

// Boost.Odeint on arrays, the fastest kind of state that it has.
template <std::size_t N, class Force>
void odeint(benchmark::State& state, std::array<double, N> q, std::array<double, N> p, Force force) {
  namespace ode = boost::numeric::odeint;
  using A = std::array<double, N>;
  for (auto _ : state) {
    ode::velocity_verlet<A> stepper;
    auto x = std::make_pair(q, p);
    const auto system = [&](const A& at, const A&, A& f, double) { force(at, f); };
    for (std::int64_t i = 0; i < steps; ++i) stepper.do_step(system, x, static_cast<double>(i) * h, h);
    benchmark::DoNotOptimize(x);
  }
  state.counters["units"] = steps;
}

/// A scheme with a tolerance in place of a step keeps its default: with a tolerance as large as h the orbit would not
/// last.
least::Request bare(std::string_view problem, std::string_view scheme = "leapfrog") {
  least::Request request = runs::defaults(problem, scheme);
  request.until_steps = true;
  request.steps = steps;
  if (least::schemes()[request.scheme].parameters[0].name != "tolerance") request.settings[0] = h;
  request.record.count = 0;
  request.limits.seconds = 1e9;
  return request;
}

void ours(benchmark::State& state, const least::Request& request, std::int64_t substeps = 1) {
  for (auto _ : state) {
    const auto result = runs::go(request);
    if (result.outcome.cost.steps != request.steps) state.SkipWithError("the run did not complete");
    benchmark::DoNotOptimize(result.outcome.final.data());
  }
  state.counters["units"] = static_cast<double>(request.steps * substeps);
}

// The hybrid on an orbit whose kinetic energy is never below K_c, so that every step moves a coordinate: at order 2
// with one substep a step, at order 4 with five.
least::Request along_a_coordinate(int order) {
  least::Request request = bare("kepler", "jacobi_maupertuis");
  request.steps = 100'000;
  runs::set(request, "critical_kinetic_energy", 0.003);
  runs::set(request, "alpha_max", std::numeric_limits<double>::quiet_NaN());
  runs::set(request, "order", order);
  runs::set(request, "energy_root", order > 2 ? 1.0 : 0.0);
  return request;
}

void add(const std::string& name, std::function<void(benchmark::State&)> body) {
  benchmark::RegisterBenchmark(name.c_str(), std::move(body))->Unit(benchmark::kMillisecond);
}

template <class Hand>
void by_hand(const std::string& problem, Hand hand) {
  add("hand/" + problem, [hand](benchmark::State& state) {
    for (auto _ : state) {
      auto end = hand(state.iterations() < 0 ? 0 : steps);  // so that the compiler does not take it for a constant
      benchmark::DoNotOptimize(end);
    }
    state.counters["units"] = steps;
  });
}

const bool registered = [] {
  by_hand("harmonic_oscillator", [](std::int64_t n) {
    double one = 1;
    benchmark::DoNotOptimize(one);
    return harmonic_by_hand(1, 0, one, one, n);
  });
  by_hand("pendulum", [](std::int64_t n) {
    double one = 1;
    benchmark::DoNotOptimize(one);
    return pendulum_by_hand(1.5, 0, one, one, n);
  });
  by_hand("kepler", [](std::int64_t n) {
    double one = 1;
    benchmark::DoNotOptimize(one);
    return kepler_by_hand(0, -4, -0.1, -0.1, one, n);
  });
  using A1 = std::array<double, 1>;
  using A2 = std::array<double, 2>;
  add("odeint/harmonic_oscillator",
      [](benchmark::State& state) { odeint<1>(state, A1{1}, A1{0}, [](const A1& q, A1& f) { f[0] = -q[0]; }); });
  add("odeint/pendulum", [](benchmark::State& state) {
    odeint<1>(state, A1{1.5}, A1{0}, [](const A1& q, A1& f) { f[0] = -std::sin(q[0]); });
  });
  add("odeint/kepler", [](benchmark::State& state) {
    odeint<2>(state, A2{0, -4}, A2{-0.1, -0.1}, [](const A2& q, A2& f) {
      const double r2 = q[0] * q[0] + q[1] * q[1], w = -1 / (r2 * std::sqrt(r2));
      f = {w * q[0], w * q[1]};
    });
  });
  for (const std::string problem : {"harmonic_oscillator", "pendulum", "kepler"}) {
    add("step/" + problem, [problem](benchmark::State& state) { ours(state, bare(problem)); });
    add("record/" + problem, [problem](benchmark::State& state) {
      least::Request request = bare(problem);
      request.record.count = steps / 1000;
      request.columns = {0, 1, 2, 3, 4};
      ours(state, request);
    });
    add("energy/" + problem, [problem](benchmark::State& state) {
      least::Request request = bare(problem);
      request.diagnostics = {0};
      ours(state, request);
    });
    bench::compare("leapfrog " + problem + ", by hand", "step/" + problem, "hand/" + problem, 1.05);
    bench::compare("… recording 1,000 samples of five columns", "record/" + problem, "hand/" + problem, 1.10);
    bench::compare("… energy diagnostic at every step", "energy/" + problem, "step/" + problem, 0);
    bench::compare("… Boost.Odeint velocity_verlet, by hand", "odeint/" + problem, "hand/" + problem, 0);
  }
  add("run/one step", [](benchmark::State& state) {
    least::Request request = bare("kepler");
    request.steps = 1;
    ours(state, request);
  });
  bench::compare("all of a run of one step of leapfrog kepler; a step", "run/one step", "step/kepler", 1000 / 16.0);
  for (const auto& scheme : least::schemes()) {
    const std::string id(scheme.id);
    if (!runs::fits("kepler", id)) continue;
    add("kepler/" + id, [id](benchmark::State& state) { ours(state, bare("kepler", id)); });
    bench::compare("kepler " + id + ", leapfrog", "kepler/" + id, "step/kepler", 0);
  }
  for (const auto& [order, substeps] : {std::pair{2, 1}, {4, 5}}) {
    const auto request = along_a_coordinate(order);
    const auto cost = runs::go(request).outcome.cost;
    const double iterations = static_cast<double>(cost.iterations) / static_cast<double>(cost.steps * substeps);
    char what[64];
    std::snprintf(what, sizeof what, "… a substep of a coordinate, order %d, %.2f iterations", order, iterations);
    const std::string name = "coordinate/" + std::to_string(order);
    add(name, [request, iterations, substeps = substeps](benchmark::State& state) {
      ours(state, request, substeps);
      if (iterations > 3.5) state.SkipWithError("a substep takes more than 3.5 iterations");
    });
    bench::compare(what, name, "step/kepler", 0);
  }
  return true;
}();

}  // namespace
