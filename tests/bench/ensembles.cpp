// Steps of members in lanes against steps of a single run, by instruction set, and members by two threads against one.
#include "tests/support/ensembles.hpp"

#include <benchmark/benchmark.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "core/ensemble/lane_members.hpp"
#include "tests/bench/peer_lanes.hpp"
#include "tests/bench/table.hpp"
#include "tests/support/runs.hpp"
#include "tests/support/texts.hpp"

namespace {

using namespace least;

constexpr std::int64_t steps_of_a_member = 4096, members = block_size;

EnsemblePlan members_of(const std::string& problem, const std::string& scheme, double step) {
  EnsemblePlan plan = test::ensemble_of(problem, scheme, 1);
  plan.request.until_steps = true;
  plan.request.steps = steps_of_a_member;
  plan.request.limits.seconds = 1e9;
  test::setting(plan, "step") = step;
  const double x = plan.request.scene->initial[0];
  test::set_members(plan, members, {{Varied::variable, 0, Spread::uniform, {x, x + 0.01}}});
  return plan;
}

/// swept_members_of() returns the same members with a parameter that differs from member to member, over `steps` steps.
EnsemblePlan swept_members_of(const EnsemblePlan& shared, std::int64_t steps) {
  EnsemblePlan plan = shared;
  const double value = plan.request.scene->parameters[0];
  plan.members.vary.push_back(
      {Varied::parameter, 0, Spread::uniform, {std::min(value, 1.01 * value), std::max(value, 1.01 * value)}});
  plan.request.steps = steps;
  return plan;
}

/// typed_members_of() returns the same members, of the same scene typed as text.
EnsemblePlan typed_members_of(const EnsemblePlan& compiled, std::string_view problem) {
  static const std::vector<texts::Typed> all = texts::all();
  const auto typed = std::ranges::find(all, problem, &texts::Typed::id);
  EnsemblePlan plan = compiled;
  plan.request = texts::typed_as(compiled.request, texts::mechanics_of(typed->definition));
  return plan;
}

void add_row(const std::string& name, std::function<void(benchmark::State&)> body) {
  benchmark::RegisterBenchmark(name.c_str(), std::move(body))->Unit(benchmark::kMillisecond);
}

void alone(benchmark::State& state, const EnsemblePlan& plan) {
  Request request = plan.request;
  request.steps *= 100;
  request.record.count = 0;
  for (auto _ : state) {
    const auto result = runs::go(request);
    if (result.outcome.cost.steps != request.steps) state.SkipWithError("the run did not complete");
  }
  state.counters["units"] = static_cast<double>(request.steps);
}
void in_lanes(benchmark::State& state, const EnsemblePlan& plan, const LaneUnit& unit) {
  const std::atomic<bool> never{false};
  const MemberColumns columns(plan.request, plan.members.vary);
  for (auto _ : state) {
    Block block{0, 0, members, {}};
    if (!run_lane_members(plan, columns, block, never, unit) || block.harvest.ended[0] != members)
      state.SkipWithError("the members did not complete");
  }
  state.counters["units"] = static_cast<double>(members * plan.request.steps);
}
void on_threads(benchmark::State& state, const EnsemblePlan& plan, unsigned threads) {
  for (auto _ : state) benchmark::DoNotOptimize(test::harvest_of(plan, threads).ended[0]);
  state.counters["units"] = static_cast<double>(plan.members.count * steps_of_a_member);
}

/// add_peer() adds Boost.Odeint on registers (odeint_members) as a baseline of Kepler's members.
void add_peer([[maybe_unused]] const LaneUnit& unit, [[maybe_unused]] double step) {
#if defined(__x86_64__)
  const auto peer = unit.width == 8 ? odeint_members<64> : unit.width == 4 ? odeint_members<32> : nullptr;
  if (!peer) return;
  const std::string name = "odeint/" + std::string(unit.name) + "/kepler";
  add_row(name, [peer, step](benchmark::State& state) {
    for (auto _ : state) benchmark::DoNotOptimize(peer(members, steps_of_a_member, step));
    state.counters["units"] = static_cast<double>(members * steps_of_a_member);
  });
  bench::compare("… ours, Boost.Odeint velocity_verlet on registers of " + std::string(unit.name),
                 "lanes/" + std::string(unit.name) + "/kepler/leapfrog", name, 1);
#endif
}

const bool ensembles_registered = [] {
  struct Case {
    std::string problem, scheme;
    double step, wide, narrow;  ///< goals with AVX-512 and AVX2: the time of a step over that of a single run
  };
  const double turn = 2 * std::numbers::pi;
  for (const auto& [problem, scheme, step, wide, narrow] :
       {Case{"kepler", "leapfrog", 0.01, 1 / 25.0, 1 / 13.0}, Case{"harmonic_oscillator", "leapfrog", 0.1, 0, 0},
        Case{"henon_heiles", "leapfrog", 0.02, 0, 0}, Case{"damped_oscillator", "contact_leapfrog", 0.1, 0, 0},
        Case{"damped_pendulum", "contact_splitting", 0.1, 0, 0},
        Case{"perturbed_kepler", "contact_splitting", 0.02, 1 / 25.0, 1 / 13.0},
        Case{"henon_heiles", "runge_kutta_4", 0.02, 0, 0}, Case{"lorenz", "runge_kutta_4", 0.01, 0, 0},
        Case{"spin_orbit", "contact_splitting", turn / 64, 1 / 20.0, 0}}) {
    const EnsemblePlan plan = members_of(problem, scheme, step);
    const std::string pair = problem + "/" + scheme;
    add_row("alone/" + pair, [plan](benchmark::State& state) { alone(state, plan); });
    for (const LaneUnit& unit : lane_units()) {
      const std::string name = "lanes/" + std::string(unit.name) + "/" + pair;
      add_row(name, [plan, unit](benchmark::State& state) { in_lanes(state, plan, unit); });
      bench::compare(scheme + " " + problem + ", members in lanes of " + std::string(unit.name) + ", a run", name,
                     "alone/" + pair,
                     unit.width == 8   ? wide
                     : unit.width == 4 ? narrow
                                       : 0);
      for (const std::int64_t steps : {steps_of_a_member, steps_of_a_member / 4}) {
        const EnsemblePlan swept = swept_members_of(plan, steps);
        const std::string row = "swept " + std::to_string(steps) + " " + name;
        add_row(row, [swept, unit](benchmark::State& state) { in_lanes(state, swept, unit); });
        bench::compare("… " + std::to_string(steps) + " steps with a parameter of each member's own, shared", row, name,
                       steps == steps_of_a_member ? 2 : 0);
      }
      if (problem == "kepler") add_peer(unit, step);
      if (problem != "kepler" && problem != "perturbed_kepler") continue;
      const EnsemblePlan typed = typed_members_of(plan, problem);
      add_row("text " + name, [typed, unit](benchmark::State& state) { in_lanes(state, typed, unit); });
      bench::compare("… " + problem + " typed, compiled", "text " + name, name, 2);
    }
  }
  EnsemblePlan plan = members_of("spin_orbit", "contact_splitting", turn / 64);
  test::set_members(plan, 8 * block_size, plan.members.vary);
  for (const unsigned threads : {1U, 2U}) {
    const std::string name = "threads/" + std::to_string(threads);
    benchmark::RegisterBenchmark(name.c_str(),
                                 [plan, threads](benchmark::State& state) { on_threads(state, plan, threads); })
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime();
  }
  bench::compare("… two threads, one", "threads/2", "threads/1", 1 / 1.9);
  return true;
}();

}  // namespace
