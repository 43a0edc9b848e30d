// Table of RESULTS.md: the energy error after ten thousand revolutions by a scheme that keeps structure, and by
// `taylor`, which keeps none. Printed before the benchmarks.
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "tests/bench/table.hpp"
#include "tests/support/runs.hpp"

namespace {

using namespace least;

struct Case {
  const char *scheme, *composition;  // nullptr: the scheme has none
  const char* dial;
  double value;
};

// Kepler, e = 0.6, from periapsis.
Request orbit(const Case& c, const std::vector<double>& times) {
  Request request = runs::defaults("kepler", c.scheme);
  runs::scene(request).initial = {0.4, 0, 0, 2};
  request.limits = {1e9, 1'000'000'000'000, 1'000'000};
  runs::at_times(request, times);
  request.columns = {1, 2, 3, 4};
  if (c.composition) runs::set(request, "composition", c.composition);
  runs::set(request, c.dial, c.value);
  return request;
}

double energy(const std::vector<double>& x) { return (x[2] * x[2] + x[3] * x[3]) / 2 - 1 / std::hypot(x[0], x[1]); }

}  // namespace

void bench::drift() {
  const double turn = 2 * std::acos(-1.0);
  constexpr std::array parts{100.0, 1000.0, 10'000.0};
  constexpr int looks = 16;  // samples of a revolution: errors oscillate along the orbit
  std::vector<double> times;
  for (const double part : parts)
    for (int k = 1; k <= looks; ++k) times.push_back((part - 1 + double(k) / looks) * turn);
  bench::heading("Ten thousand revolutions");
  std::printf(
      "Kepler, e = 0.6: the largest error of the energy in the 100th, the 1,000th and the 10,000th revolution.\n\n"
      "| scheme | setting | force evaluations | ms | 100 | 1,000 | 10,000 |\n|---|---|---|---|---|---|---|\n");
  for (const Case& c : {Case{"time_transformed", "kahan_li_6", "sigma", 0.5},
                        {"time_transformed", "kahan_li_8", "sigma", 0.5},
                        {"time_transformed", "kahan_li_8", "sigma", 0.25},
                        {"taylor", nullptr, "tolerance", 1e-4},
                        {"taylor", nullptr, "tolerance", 1e-8},
                        {"taylor", nullptr, "tolerance", 1e-12},
                        {"taylor", nullptr, "tolerance", 1e-15}}) {
    const auto result = runs::go(orbit(c, times));
    const std::string setting = (c.composition ? std::string(c.composition) + ", " : "") + c.dial;
    std::printf("| `%s` | %s = %g | %lld | %.0f |", c.scheme, setting.c_str(), c.value,
                static_cast<long long>(result.outcome.cost.force_evaluations), 1e3 * result.outcome.cost.seconds);
    for (std::size_t end = looks; end <= result.rows.size(); end += looks) {
      double most = 0;
      for (std::size_t i = end - looks; i < end; ++i) most = std::max(most, std::abs(energy(result.rows[i]) + 0.5));
      std::printf(" %.1e |", most);
    }
    std::printf("%s\n", result.outcome.stop.reason == ReturnCode::completed ? "" : " stopped");
  }
}
