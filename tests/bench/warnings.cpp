// Table of RESULTS.md: whether the warnings of runs are right, over random scenes at coarse settings.
#include <cstdio>

#include "tests/bench/table.hpp"
#include "tests/support/coarse_runs.hpp"
#include "tests/support/narrow_forces.hpp"

namespace {

/// narrow_rows() prints how often schemes at their defaults are right about forces narrower than a step.
void narrow_rows() {
  constexpr int drawn = 60;
  std::printf(
      "\n%d random scenes of each family of narrow forces (Gaussians, also times a cosine, sech², exp(−u⁴), tanh, of "
      "widths\nfrom a half to a thousandth of the span), each scheme at its default tolerance. The right end is from a "
      "quadrature, or\nfrom fine runs of kahan_li_8 or runge_kutta_4. Wrong: by more than 1e4 tolerances.\n\n",
      drawn);
  std::printf("| forces | scheme | runs | wrong | silently | goal | right with a warning | goal |\n");
  std::printf("|---|---|---|---|---|---|---|---|\n");
  for (const narrow::Family family : narrow::families) {
    const std::vector<narrow::Case> cases = narrow::draw(family, drawn, 2026);
    for (const std::string_view scheme : {"taylor", "dormand_prince_5", "fehlberg_78"}) {
      const narrow::Count count = narrow::count_of(cases, scheme);
      std::printf("| %.*s | %.*s | %d | %d | %d | 0 | %d | 1 %% |\n", static_cast<int>(narrow::name(family).size()),
                  narrow::name(family).data(), static_cast<int>(scheme.size()), scheme.data(), count.runs, count.wrong,
                  count.silent, count.alarmed);
    }
  }
}

}  // namespace

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
  narrow_rows();
}
