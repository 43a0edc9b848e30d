// Tables of RESULTS.md: the errors of each scheme for the same work on the same orbit, and how well every scene is
// solved. Printed before the benchmarks.
#include <cmath>
#include <cstdio>

#include "tests/bench/equal_work.hpp"
#include "tests/bench/table.hpp"

namespace {

using namespace least;

struct Case {
  const char* scheme;
  const char* composition;  // nullptr: the scheme has none
};

// Kepler, e = 0.6, from periapsis, 100 periods.
Request orbit(const Case& c, double step) {
  Request request = runs::defaults("kepler", c.scheme);
  runs::scene(request).initial = {0.4, 0, 0, 2};
  request.end = 200 * std::acos(-1.0);
  request.limits = {1e9, 1'000'000'000'000, 1'000'000};
  runs::only_final(request);
  runs::set(request, "step", step);
  if (c.composition) runs::set(request, "composition", c.composition);
  return request;
}

// Every scene at its default start, span and step, under the scheme its kind calls for and with the
// composition kahan_li_6 on top.
void every_scene() {
  std::printf("| id | system | scheme | step | force evaluations | error | with kahan_li_6 | error |\n");
  std::printf("|---|---|---|---|---|---|---|---|\n");
  for (const ProblemCard& problem : runs::problem_cards()) {
    const char* scheme = nullptr;
    for (const char* id : {"leapfrog", "contact_leapfrog", "contact_splitting", "variational_midpoint"})
      if (!scheme && runs::fits(problem.id, id)) scheme = id;
    std::printf("| `%s` | %s | `%s` ", std::string(problem.id).c_str(), std::string(problem.title).c_str(), scheme);
    for (const bool composed : {false, true}) {
      Request request = runs::defaults(problem.id, scheme);
      request.limits = {60, 1'000'000'000, 1'000'000};
      runs::only_final(request);
      if (composed) runs::set(request, "composition", "kahan_li_6");
      runs::ask(request, "error");
      const auto outcome = runs::go(request).outcome;
      if (!composed) std::printf("| %g ", request.settings[0]);
      std::printf("| %lld | %.1e%s ", static_cast<long long>(outcome.cost.force_evaluations),
                  runs::number(outcome.diagnostics, "error/max"),
                  outcome.stop.reason == ReturnCode::left_domain ? ", to its surface" : "");
    }
    std::printf("|\n");
  }
}

}  // namespace

void bench::choice() {
  constexpr double budget = 200'000;  // force evaluations
  bench::heading("Equal work");
  std::printf(
      "Kepler, e = 0.6, 100 periods, the step chosen so that each scheme spends about %.0f force evaluations.\n\n",
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
    const double step = bench::at_cost(budget, 0.01, [&c](double h) { return orbit(c, h); });
    Request request = orbit(c, step);
    const double ms = bench::milliseconds(request);
    for (const auto* diagnostic : {"energy", "error"}) runs::ask(request, diagnostic);
    const auto result = runs::go(request);
    const auto& d = result.outcome.diagnostics;
    std::printf("| `%s` | %s | %.4f | %lld | %.1f | %.1e | %.1e | %.1e |\n", c.scheme,
                c.composition ? c.composition : "–", step,
                static_cast<long long>(result.outcome.cost.force_evaluations), ms, runs::number(d, "error/final"),
                runs::number(d, "energy/max_abs_error"), runs::number(d, "energy/drift_per_time") * request.end);
  }
  bench::heading("Every scene");
  std::printf(
      "At its default start, span and step: the largest error along the run, against a closed form or a run in quad\n"
      "precision, as max |Δ| / max(1, |state|). A chaotic scene's states mean nothing after a while.\n\n");
  every_scene();
}
