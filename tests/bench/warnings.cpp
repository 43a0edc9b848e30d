// Table of RESULTS.md: whether runs say of themselves what is true, over random scenes at coarse settings.
#include <cstdio>

#include "tests/bench/table.hpp"
#include "tests/support/coarse_runs.hpp"

void bench::warnings() {
  constexpr int drawn = 2000;
  bench::heading("Warnings");
  std::printf(
      "%d random scenes over the catalogue, each under a random scheme that fits it, at steps up to 64 times the\n"
      "suggested and tolerances up to 0.1. The largest error along the run is against Bulirsch and Stoer at 1e-13; "
      "scenes\n"
      "on which Dormand and Prince at 1e-13 do not agree with that are left out. Wrong: by more than 0.3; right: to "
      "0.01.\n\n",
      drawn);
  const coarse::Count count = coarse::sample(drawn);
  const auto percent = [](int part, int whole) { return 100.0 * part / whole; };
  std::printf("| runs | completed | wrong | wrong without a warning | goal | right | right with a warning | goal |\n");
  std::printf("|---|---|---|---|---|---|---|---|\n");
  std::printf("| %d | %d | %d | %d, %.2f %% of runs | 0.5 %% | %d | %d, %.1f %% of them | 5 %% |\n", count.runs,
              count.completed, count.wrong, count.silent, percent(count.silent, count.runs), count.right, count.alarmed,
              percent(count.alarmed, count.right));
}
