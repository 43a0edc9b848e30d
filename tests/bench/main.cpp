// Google Benchmark, then a table of ratios within the run: the smallest of interleaved repetitions of each.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <vector>

#include "tests/bench/table.hpp"

namespace {

struct Row {
  std::string what, name, baseline;
  double goal;
};
std::vector<Row>& rows() {
  static std::vector<Row> all;
  return all;
}

class Reporter final : public benchmark::ConsoleReporter {
 public:
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs)
      if (run.run_type == Run::RT_Iteration && !run.error_occurred) {
        const std::string name =
            run.run_name.function_name + (run.run_name.args.empty() ? "" : "/" + run.run_name.args);
        // Processor time, which other work on the machine disturbs least; real time where threads talk to each other.
        const bool real = run.run_name.time_type == "real_time";
        const double ns = (real ? run.GetAdjustedRealTime() : run.GetAdjustedCPUTime()) *
                          benchmark::GetTimeUnitMultiplier(benchmark::kNanosecond) /
                          benchmark::GetTimeUnitMultiplier(run.time_unit);
        const auto [place, fresh] = least.try_emplace(name, ns);
        if (!fresh) place->second = std::min(place->second, ns);
        const auto items = run.counters.find("units");
        if (items != run.counters.end()) units[name] = items->second;
      }
    ConsoleReporter::ReportRuns(runs);
  }
  std::map<std::string, double> least;  // nanoseconds per iteration
  std::map<std::string, double> units;  // steps or numbers per iteration
};

}  // namespace

void bench::compare(const std::string& what, const std::string& name, const std::string& baseline, double goal) {
  rows().push_back({what, name, baseline, goal});
}

int main(int argc, char** argv) {
  std::vector<char*> arguments(argv, argv + argc);
  char interleave[] = "--benchmark_enable_random_interleaving=true", repeat[] = "--benchmark_repetitions=9",
       brief[] = "--benchmark_report_aggregates_only=false", time[] = "--benchmark_min_time=0.05";
  arguments.insert(arguments.begin() + 1,
                   {interleave, repeat, brief, time});  // what the caller says comes later and wins
  int count = static_cast<int>(arguments.size());
  benchmark::Initialize(&count, arguments.data());
  if (benchmark::ReportUnrecognizedArguments(count, arguments.data())) return 2;
  bench::choice();
  bench::hybrid();
  bench::digits();
  Reporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);

  std::printf("\n%-58s %12s %12s %8s %8s\n", "smallest of the repetitions, ns per step or number", "ours", "baseline",
              "ratio", "goal");
  for (const Row& row : rows()) {
    const auto ours = reporter.least.find(row.name), theirs = reporter.least.find(row.baseline);
    if (ours == reporter.least.end() || theirs == reporter.least.end()) continue;
    const double unit = ours->second / reporter.units[row.name],
                 baseline = theirs->second / reporter.units[row.baseline], ratio = unit / baseline;
    std::printf("%-58s %12.2f %12.2f %8.3f ", row.what.c_str(), unit, baseline, ratio);
    if (row.goal > 0) std::printf("%8.2f %s\n", row.goal, ratio <= row.goal ? "" : "  over");
    if (row.goal <= 0) std::printf("%8s\n", "");
  }
  return 0;
}
