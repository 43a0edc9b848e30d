// The cost of the way from request to response beside the integration, and our JSON against a tree of nlohmann's.
#include <benchmark/benchmark.h>
#include <httplib.h>
#include <spdlog/spdlog.h>

#include <nlohmann/json.hpp>

#include "server/encode/run_answer.hpp"
#include "server/service.hpp"
#include "server/simulate.hpp"
#include "tests/bench/table.hpp"
#include "tests/support/runs.hpp"

namespace {

using namespace least;

// One POST through a socket of the loopback interface: 1e6 steps and 1,000 samples, answered as JSON.
void end_to_end(benchmark::State& state) {
  spdlog::set_level(spdlog::level::off);  // the standard output is for the results
  server::Settings settings;
  settings.port = 0;
  server::Service service(settings, {});
  if (service.start()) return state.SkipWithError("the service does not start");
  httplib::Client client("127.0.0.1", service.port());
  client.set_keep_alive(true);
  client.set_tcp_nodelay(true);
  const std::string body =
      R"({"problem":"kepler","scheme":{"id":"leapfrog","step":0.01},"until":{"steps":1000000},"record":{"samples":1000},)"
      R"("columns":["t","x","y","px","py"],"diagnostics":[]})";
  for (auto _ : state) {
    const auto answer = client.Post("/v1/simulate", body, "application/json");
    if (!answer || answer->status != 200) state.SkipWithError("no answer");
  }
  state.counters["units"] = 1e6;
  service.stop();
}

// Ready holds 1e5 samples of five columns that exist already.
struct Ready {
  Request request;
  Samples samples;
  Solution outcome;
  Ready() {
    request = runs::defaults("kepler", "leapfrog");
    request.until_steps = true;
    request.steps = 99'999;
    const std::atomic<bool> cancelled{false};
    outcome = request.scene->mechanics->run(request, samples, cancelled);
  }
};
const Ready& ready() {
  static const Ready all;
  return all;
}

void json_ours(benchmark::State& state) {
  const auto& [request, samples, outcome] = ready();
  server::KeptRows rows(request.columns.size());
  rows.append(samples.values);
  const server::FinishedRun run{{request, request.scene->card(), schemes()[request.scheme]}, outcome, rows};
  for (auto _ : state) benchmark::DoNotOptimize(server::whole_answer(server::forms()[0], run).body.size());
  state.counters["units"] = static_cast<double>(samples.values.size());
}

constexpr const char* names[] = {"t", "x", "y", "px", "py"};

// The tree filled as its shape suggests: each number is pushed to its column.
void json_tree(benchmark::State& state) {
  const Samples& samples = ready().samples;
  for (auto _ : state) {
    nlohmann::json tree;
    for (std::size_t i = 0; i < samples.values.size(); ++i)
      tree["trajectory"][names[i % 5]].push_back(samples.values[i]);
    benchmark::DoNotOptimize(tree.dump().size());
  }
  state.counters["units"] = static_cast<double>(samples.values.size());
}

// The fastest way to fill the tree: arrays are filled apart and then moved in.
void json_moved(benchmark::State& state) {
  const Samples& samples = ready().samples;
  for (auto _ : state) {
    nlohmann::json columns[5];
    for (std::size_t i = 0; i < samples.values.size(); ++i) columns[i % 5].push_back(samples.values[i]);
    nlohmann::json tree;
    for (std::size_t i = 0; i < 5; ++i) tree["trajectory"][names[i]] = std::move(columns[i]);
    benchmark::DoNotOptimize(tree.dump().size());
  }
  state.counters["units"] = static_cast<double>(samples.values.size());
}

const bool registered = [] {
  benchmark::RegisterBenchmark("request/kepler", end_to_end)->Unit(benchmark::kMillisecond)->UseRealTime();
  benchmark::RegisterBenchmark("json/ours", json_ours)->Unit(benchmark::kMillisecond);
  benchmark::RegisterBenchmark("json/tree", json_tree)->Unit(benchmark::kMillisecond);
  benchmark::RegisterBenchmark("json/moved", json_moved)->Unit(benchmark::kMillisecond);
  bench::compare("HTTP request, 1e6 steps, 1,000 samples; the step alone", "request/kepler", "step/kepler", 1.2);
  bench::compare("JSON of 1e5 samples x 5; a nlohmann tree", "json/ours", "json/tree", 0.3);
  bench::compare("… the same tree, its arrays built apart and moved in", "json/ours", "json/moved", 0);
  return true;
}();

}  // namespace
