// Table of RESULTS.md: Wisdom and Holman's splitting, as kepler_splitting, on the outer solar system, against WHFast
// and other schemes. Printed before the benchmarks.
#include <algorithm>
#include <cstdio>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "server/decode/scene_files.hpp"
#include "tests/bench/table.hpp"
#include "tests/support/texts.hpp"

namespace {

using namespace least;

constexpr double days = 1e7;
/// Time and error of REBOUND's WHFast over the same `days` in steps of 100, on a machine like the one that the goals
/// were set on.
constexpr double whfast_ms = 134, whfast_error = 2.2e-8;

Request request_of(const std::shared_ptr<const Mechanics>& mechanics, std::string_view scheme, double step) {
  std::vector<double> start;
  for (const auto& variable : mechanics->card().variables)
    if (!variable.hidden) start.push_back(variable.value);
  Request request = texts::request_by(scheme, mechanics, start, days);
  runs::set(request, "step", step);
  request.limits = {1e9, 1'000'000'000, 1'000'000};
  return request;
}

/// time_of() returns the milliseconds of a run, the least of five.
double time_of(const Request& request) {
  double seconds = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 5; ++k) seconds = std::min(seconds, runs::go(request).outcome.cost.seconds);
  return 1e3 * seconds;
}
double error_of(Request request) {
  runs::ask(request, "energy");
  return runs::number(runs::go(request).outcome.diagnostics, "energy/max_rel_error");
}

/// row() prints a row; `goal` is in milliseconds, 0: none.
void row(const std::string& name, const Request& request, double step, double error, double goal) {
  const double ms = time_of(request);
  char judged[64] = "–";
  if (goal > 0) std::snprintf(judged, sizeof judged, "%.0f, %s", goal, ms <= goal ? "met" : "not met");
  std::printf("| %s | %.0f | %.1e | %.0f | %.2f | %s |\n", name.c_str(), step, error, ms, 1e3 * ms * step / days,
              judged);
}

}  // namespace

void bench::planets() {
  const auto all = server::text_problems();
  const auto found = std::ranges::find_if(
      all, [](const server::TextProblem& one) { return one.mechanics->card().id == "outer_solar_system"; });
  if (found == all.end() || !is_wanted("outer solar system")) return;
  heading("Planets, by Wisdom and Holman's splitting");
  std::printf(
      "The outer solar system over 1e7 days by `kepler_splitting`: the largest relative error of the energy, and the\n"
      "time of the run. REBOUND's WHFast, measured by itself, takes %.0f ms in steps of 100 days, to %.1e. The goals\n"
      "are an energy to 2e-8 in 1.2 times that, and one to 1e-10 by `aba_864` or `aba_1064` in twice that: in the\n"
      "longest steps that keep it to there.\n\n"
      "| scheme | step, days | energy | ms | µs a step | goal, ms |\n|---|---|---|---|---|---|\n",
      whfast_ms, whfast_error);
  const Progress told("outer solar system");
  const auto& mechanics = found->mechanics;
  const auto by = [&](const char* splitting, const char* coordinates, double step) {
    Request request = request_of(mechanics, "kepler_splitting", step);
    runs::set(request, "coordinates", coordinates);
    runs::set(request, "splitting", splitting);
    return request;
  };
  for (const char* coordinates : {"jacobi", "heliocentric"}) {
    for (const double step : {100.0, 50.0}) {
      const Request request = by("strang", coordinates, step);
      row(std::string("Strang, ") + coordinates, request, step, error_of(request), 0);
    }
    for (const auto& [most, times, splittings] :
         {std::tuple{2e-8, 1.2, std::vector{"saba_2", "saba_4", "aba_864", "aba_1064"}},
          {1e-10, 2.0, std::vector{"aba_864", "aba_1064"}}})
      for (const char* splitting : splittings)
        for (const double step : {800, 700, 600, 500, 450, 400, 350, 300, 250, 200, 150, 100, 50}) {
          const Request request = by(splitting, coordinates, step);
          const double seen = error_of(request);
          if (!(seen <= most)) continue;
          row(std::string(splitting) + ", " + coordinates, request, step, seen, times * whfast_ms);
          break;
        }
  }
  const Request plain = request_of(mechanics, "leapfrog", 100);
  row("`leapfrog`", plain, 100, error_of(plain), 0);
}
