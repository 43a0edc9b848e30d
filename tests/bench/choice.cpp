// The table of the README: what each scheme makes of the same work on the same orbit. Printed before the benchmarks.
#include <cmath>
#include <cstdio>

#include "core/composition.hpp"
#include "tests/bench/table.hpp"
#include "tests/support/runs.hpp"

namespace {

using namespace least;

struct Case {
  const char* scheme;
  const char* composition;  // nullptr: takes none
};

// Kepler, e = 0.6, from periapsis, 100 periods.
Request orbit(const Case& c, double step) {
  Request request = runs::defaults("kepler", c.scheme);
  request.initial = {0.4, 0, 0, 2};
  request.end = 200 * std::acos(-1.0);
  request.record.count = 0;
  request.limits = {1e9, 1'000'000'000'000, 1'000'000};
  request.settings[0] = step;
  if (c.composition)
    for (std::size_t i = 0; i < compositions::names.size(); ++i)
      if (compositions::names[i] == c.composition) request.settings[1] = static_cast<double>(i);
  return request;
}

}  // namespace

void bench::choice() {
  constexpr double budget = 200'000;  // force evaluations
  std::printf("Kepler, e = 0.6, 100 periods, the step chosen so that each scheme spends about %.0f force evaluations\n",
              budget);
  std::printf(
      "| scheme | composition | step | force evaluations | ms | error at the end | max. energy error | energy drift "
      "over the run |\n|---|---|---|---|---|---|---|---|\n");
  for (const Case& c : {Case{"explicit_euler", nullptr},
                        {"explicit_midpoint", nullptr},
                        {"runge_kutta_4", nullptr},
                        {"symplectic_euler", nullptr},
                        {"leapfrog", "none"},
                        {"ruth_3", nullptr},
                        {"leapfrog", "suzuki_4"},
                        {"leapfrog", "kahan_li_6"},
                        {"leapfrog", "kahan_li_8"},
                        {"leapfrog", "sofroniou_spaletta_10"},
                        {"variational_midpoint", "none"},
                        {"galerkin_4", "none"}}) {
    // Work per step is not known beforehand for implicit schemes: find it, then choose the step.
    double step = 0.01;
    for (int k = 0; k < 4; ++k) {
      const auto probe = runs::go(orbit(c, step));
      step *= static_cast<double>(probe.outcome.cost.force_evaluations) / budget;
    }
    Request request = orbit(c, step);
    double seconds = 1e9;
    for (int k = 0; k < 5; ++k) seconds = std::min(seconds, runs::go(request).outcome.cost.seconds);
    request.diagnostics = {0, 3};  // energy, error
    const auto result = runs::go(request);
    const auto& d = result.outcome.diagnostics;
    std::printf("| %s | %s | %.4f | %lld | %.1f | %.1e | %.1e | %.1e |\n", c.scheme, c.composition ? c.composition : "",
                step, static_cast<long long>(result.outcome.cost.force_evaluations), seconds * 1e3,
                runs::number(d, "error/final"), runs::number(d, "energy/max_abs_error"),
                runs::number(d, "energy/drift_per_time") * request.end);
  }
  std::printf("\n");
}
