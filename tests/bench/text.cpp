// Scenes typed as text against the same scenes compiled: nanoseconds per step, and from the text to the first step.
#include <benchmark/benchmark.h>

#include "tests/bench/table.hpp"
#include "tests/support/texts.hpp"

namespace {

using namespace least;

Request bare_request(const std::string& id, const char* scheme, const char* composition, std::int64_t steps) {
  Request request = runs::defaults(id, scheme);
  if (composition) runs::set(request, "composition", composition);
  request.until_steps = true;
  request.steps = steps;
  request.columns = {0};
  request.limits = {1e9, 1'000'000'000'000, 1'000'000};
  runs::only_final(request);
  return request;
}

void add_run(const std::string& name, const Request& request) {
  benchmark::RegisterBenchmark(name.c_str(), [request](benchmark::State& state) {
    for (auto _ : state) {
      auto result = runs::go(request);
      if (result.outcome.stop.reason != ReturnCode::completed) state.SkipWithError("the run stopped");
      benchmark::DoNotOptimize(result);
    }
    state.counters["units"] = static_cast<double>(request.steps);
  });
}

const texts::Typed& typed(std::string_view id) {
  static const std::vector<texts::Typed> all = texts::all();
  for (const auto& one : all)
    if (one.id == id) return one;
  throw std::out_of_range(std::string(id));
}

const bool registered_texts = [] {
  const struct {
    const char *id, *scheme, *composition;
    std::int64_t steps;
    double goal;
  } rows[] = {{"kepler", "leapfrog", nullptr, 100'000, 4},
              {"kepler", "leapfrog", "kahan_li_8", 10'000, 4},
              {"perturbed_kepler", "contact_splitting", nullptr, 100'000, 4},
              {"perturbed_kepler", "contact_splitting", "kahan_li_8", 10'000, 4},
              {"kepler", "taylor", nullptr, 1'000, 4},
              {"kepler", "runge_kutta_4", nullptr, 30'000, 0},
              {"kepler", "galerkin_4", nullptr, 1'000, 0},
              {"double_pendulum", "galerkin_4", nullptr, 1'000, 0},
              {"van_der_pol", "runge_kutta_4", nullptr, 30'000, 0}};
  for (const auto& row : rows) {
    const Request compiled = bare_request(row.id, row.scheme, row.composition, row.steps);
    std::string name = std::string(row.id) + "/" + row.scheme;
    if (row.composition) name += std::string("+") + row.composition;
    add_run("compiled/" + name, compiled);
    add_run("text/" + name, texts::typed_as(compiled, texts::mechanics_of(typed(row.id).definition)));
    bench::compare(name + ": text, compiled", "text/" + name, "compiled/" + name, row.goal);
  }
  // From the text to the end of a run of one step, which is a little more than to the first step.
  benchmark::RegisterBenchmark("text/first step", [](benchmark::State& state) {
    for (auto _ : state) {
      const Request one = bare_request("kepler", "leapfrog", nullptr, 1);
      auto result = runs::go(texts::typed_as(one, texts::mechanics_of(typed("kepler").definition)));
      benchmark::DoNotOptimize(result);
    }
    state.counters["units"] = 1;
  });
  return true;
}();

}  // namespace
