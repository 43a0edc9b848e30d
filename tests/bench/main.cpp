// The results, as Markdown on the standard output: the machine, the tables, and last the ratios of Google Benchmark's
// measurements within the run, the smallest of interleaved repetitions of each. The standard error reports the
// progress. --table=NAME prints that table alone; --row=TEXT, of a table of scenes, only the rows whose title contains
// TEXT.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iostream>
#include <map>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
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
        // Processor time, because other work on the machine disturbs it least; real time where threads wait for each
        // other.
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

/// The processor as the kernel calls it.
std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "an unnamed processor";
}

/// where_and_when() prints the machine, compiler, commit and date: numbers mean nothing without them. LEAST_COMMIT is
/// set by ./dev bench.
void where_and_when() {
  char date[32];
  const std::time_t now = std::time(nullptr);
  std::strftime(date, sizeof date, "%Y-%m-%d", std::gmtime(&now));
  const char* commit = std::getenv("LEAST_COMMIT");
  std::printf("# Results of the benchmark\n\n%s, %u cores; g++ %s; commit %s; %s. Written by `./dev bench --write`.\n",
              processor().c_str(), std::thread::hardware_concurrency(), __VERSION__, commit ? commit : "unknown", date);
}

void ratios(const std::map<std::string, double>& least, const std::map<std::string, double>& units) {
  bench::heading("Ratios");
  std::printf(
      "Nanoseconds per step or number, the smallest of the repetitions; one run on one machine, ratios vary by a few\n"
      "hundredths.\n\n| ours, baseline | ours | baseline | ratio | goal |\n|---|---|---|---|---|\n");
  for (const Row& row : rows()) {
    const auto ours = least.find(row.name), theirs = least.find(row.baseline);
    if (ours == least.end() || theirs == least.end()) continue;
    const double unit = ours->second / units.at(row.name), baseline = theirs->second / units.at(row.baseline),
                 ratio = unit / baseline;
    std::printf("| %s | %.2f | %.2f | %.3f | ", row.what.c_str(), unit, baseline, ratio);
    if (row.goal > 0) std::printf("%.2f%s ", row.goal, ratio <= row.goal ? "" : ", over");
    std::printf("|\n");
  }
}

/// measurements() runs all benchmarks of Google Benchmark and prints the ratios between them.
void measurements() {
  Reporter reporter;
  reporter.SetOutputStream(&std::cerr);
  benchmark::RunSpecifiedBenchmarks(&reporter);
  ratios(reporter.least, reporter.units);
}

constexpr std::pair<std::string_view, void (*)()> tables[] = {
    {"choice", bench::choice},     {"hybrid", bench::hybrid}, {"drag", bench::drag},
    {"drift", bench::drift},       {"digits", bench::digits}, {"lifts", bench::lifts},
    {"planets", bench::planets},   {"scenes", bench::scenes}, {"derivatives", bench::derivatives},
    {"warnings", bench::warnings}, {"auto", bench::advice},   {"ratios", measurements}};

/// take() removes an argument that begins with `key` and returns its value; empty where there is none.
std::string take(std::vector<char*>& arguments, std::string_view key) {
  for (std::size_t i = 1; i < arguments.size(); ++i)
    if (const std::string_view argument = arguments[i]; argument.starts_with(key)) {
      arguments.erase(arguments.begin() + static_cast<std::ptrdiff_t>(i));
      return std::string(argument.substr(key.size()));
    }
  return {};
}

std::string only_row;

}  // namespace

void bench::heading(const char* title) { std::printf("\n## %s\n\n", title); }

bench::Progress::Progress(std::string title) : title_(std::move(title)) {
  std::fflush(stdout);
  std::fprintf(stderr, "%s …", title_.c_str());
}
bench::Progress::~Progress() { std::fprintf(stderr, " %.1f s\n", watch_.seconds()); }

bool bench::is_wanted(std::string_view title) { return title.find(only_row) != title.npos; }

void bench::compare(const std::string& what, const std::string& name, const std::string& baseline, double goal) {
  rows().push_back({what, name, baseline, goal});
}

int main(int argc, char** argv) {
  std::vector<char*> arguments(argv, argv + argc);
  const std::string only = take(arguments, "--table=");
  only_row = take(arguments, "--row=");
  if (!only.empty() &&
      std::ranges::find(tables, only, &std::pair<std::string_view, void (*)()>::first) == std::end(tables)) {
    std::fprintf(stderr, "bench: --table=%s: there is", only.c_str());
    for (const auto& table : tables) std::fprintf(stderr, " %s", table.first.data());
    std::fprintf(stderr, "\n");
    return 2;
  }
  char interleave[] = "--benchmark_enable_random_interleaving=true", repeat[] = "--benchmark_repetitions=9",
       brief[] = "--benchmark_report_aggregates_only=false", time[] = "--benchmark_min_time=0.05";
  arguments.insert(arguments.begin() + 1,
                   {interleave, repeat, brief, time});  // arguments of the caller come later and win
  int count = static_cast<int>(arguments.size());
  benchmark::Initialize(&count, arguments.data());
  if (benchmark::ReportUnrecognizedArguments(count, arguments.data())) return 2;
  where_and_when();
  for (const auto& [name, print] : tables) {
    if (!only.empty() && name != only) continue;
    const bench::Progress whole("Table " + std::string(name));
    print();
  }
  return 0;
}
