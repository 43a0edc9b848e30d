// The structure that contact schemes keep, and its consequences: the contact form and its volume to round-off, the law
// of decay to the scheme's order, heat and entropy to the last digit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/schemes/list.hpp"
#include "least_problems.hpp"
#include "tests/support/runs.hpp"
#include "tests/support/tangents.hpp"

namespace {

using namespace least;
using namespace least::problems;

bool is_contact(const ProblemCard& card) {
  return std::ranges::find(card.diagnostics, "volume", &DiagnosticCard::name) != card.diagnostics.end();
}
Request measured(const ProblemCard& card, std::size_t scheme, double step, std::int64_t steps) {
  Request request = runs::defaults(card.id, schemes()[scheme].id);
  if (!schemes()[scheme].own_clock) runs::set(request, "step", step);
  request.until_steps = true;
  request.steps = steps;
  runs::only_final(request);
  if (runs::regular_start(request, 0.05)) {  // away from the singular start
    runs::scene(request).start = 0.05;
    runs::scene(request).initial = *runs::regular_start(request, 0.05);
  }
  for (const char* diagnostic : {"structure", "volume", "decay"}) runs::ask(request, diagnostic);
  return request;
}

// φ*η = λη and det DΦ = λⁿ⁺¹ along the run, by every contact scheme on every contact problem, with every composition,
// splitting and number of stages; and by no other.
TEST(ContactStructure, IsKeptByContactSchemesAndNoOthers) {
  int scenes = 0, kept = 0, lost = 0, unknown = 0;
  for (const auto& card : runs::problem_cards()) {
    if (!is_contact(card)) continue;
    ++scenes;
    const double step = card.suggested[0].second;
    for (const std::size_t scheme : card.schemes) {
      const SchemeCard& about = schemes()[scheme];
      Request request = measured(card, scheme, step, 40);
      const auto check = [&](const Request& asked) {
        const auto result = runs::go(asked);
        ASSERT_EQ(result.outcome.stop.reason, ReturnCode::completed) << card.id << ' ' << about.id;
        EXPECT_LT(runs::number(result.outcome.diagnostics, "structure/max_defect"), 1e-12)
            << card.id << ' ' << about.id;
        EXPECT_LT(runs::number(result.outcome.diagnostics, "volume/max_defect"), 1e-12) << card.id << ' ' << about.id;
        ++kept;
      };
      if (about.structure == "contact" || about.id == "time_transformed") {  // the latter in the space extended by time
        check(request);
        for (const auto& parameter : about.parameters) {
          Request varied = request;
          for (std::size_t choice = 0; choice < parameter.choices.size(); ++choice) {
            runs::set(varied, parameter.name, parameter.choices[choice]);
            check(varied);
          }
          for (int stages = 1; parameter.name == "stages" && stages <= 3; ++stages) {
            runs::set(varied, "stages", stages);
            check(varied);
          }
        }
      } else if (about.own_clock) {  // such a step depends on the ones before: no map of the state
        const auto result = runs::go(request);
        EXPECT_EQ(about.structure, "none") << about.id;
        EXPECT_TRUE(std::isnan(runs::number(result.outcome.diagnostics, "structure/max_defect"))) << about.id;
        EXPECT_TRUE(std::isnan(runs::number(result.outcome.diagnostics, "volume/max_defect"))) << about.id;
        ++unknown;
      } else if (about.id == "runge_kutta_4") {
        request = measured(card, scheme, card.id == "damped_kepler" ? 10 * step : 0.3, 3);  // it falls in steps of 0.3
        if (card.id == "spin_orbit") runs::set(request, "epsilon", 0.5);  // a round moon feels next to nothing
        const auto result = runs::go(request);
        EXPECT_GT(runs::number(result.outcome.diagnostics, "structure/max_defect"), 1e-8) << card.id;
        EXPECT_GT(runs::number(result.outcome.diagnostics, "volume/max_defect"), 1e-8) << card.id;
        ++lost;
      }
    }
  }
  EXPECT_GT(kept, 150);
  EXPECT_EQ(lost, scenes);
  EXPECT_EQ(unknown, 4 * scenes);  // the schemes with adaptive steps
}

/// The implicit midpoint rule in (q, p, s) itself, by fixed-point iteration: it looks like a contact scheme, but is
/// none.
struct PlainMidpoint {
  template <class P, class X>
  struct Stepper {
    P problem;
    StepStatus step(X& x, const typename X::Time& h) noexcept {
      X middle = x;
      middle.t = x.t + 0.5 * h;
      X rate{};
      for (int k = 0; k < 200; ++k) {
        rate = derivative(problem, middle);
        for (std::size_t i = 0; i < X::size; ++i) middle[i] = x[i] + (0.5 * h) * rate[i];
      }
      for (std::size_t i = 0; i < X::size; ++i) x[i] = x[i] + h * rate[i];
      return StepStatus::ok;
    }
  };
  template <class P, class X>
  Stepper<P, X> bind(const P& problem, const X&) const {
    return {problem};
  }
};
TEST(ContactStructure, PlainMidpointDoesNotKeepIt) {
  const auto defect = [](const auto& scheme, const auto& problem) {
    using X = FullStateOf<std::remove_cvref_t<decltype(problem)>>;
    X x;
    x.t = 0.3;
    for (std::size_t i = 0; i < X::size; ++i) x[i] = 0.5 + 0.1 * double(i);
    return contact_defect(x, tangent_map(scheme, problem, x, 0.1).value()).defect;
  };
  const auto check = [&](const auto& problem) {
    EXPECT_GT(defect(PlainMidpoint{}, problem), 1e-7);
    EXPECT_LT(defect(ContactVariationalMidpoint{0.1}, problem), 1e-12);
    EXPECT_LT(defect(ContactGauss{0.1, 1}, problem), 1e-12);
  };
  check(DampedOscillator<>{});
  check(ModulatedOscillator<>{});
  check(DampedPendulum<>{});
  check(CosmologicalOscillator<>{});
  check(ScalarFieldCosmology<>{});
}

// ---- laws that the exact motion keeps, as residuals

struct Residuals {
  double decay, volume;
};
Residuals residuals(std::string_view problem, std::string_view scheme, std::string_view setting, double value,
                    std::string_view choice, double h) {
  Request request = runs::defaults(problem, scheme);
  runs::set(request, "step", h);
  if (!choice.empty()) runs::set(request, setting, choice);
  if (value > 0) runs::set(request, setting, value);
  request.end = 4;
  runs::only_final(request);
  runs::ask(request, "decay");
  runs::ask(request, "volume");
  const auto result = runs::go(request);
  EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed);
  return {runs::number(result.outcome.diagnostics, "decay/max_residual"),
          runs::number(result.outcome.diagnostics, "volume/invariant_residual")};
}
TEST(ContactStructure, ResidualsFallWithTheOrder) {
  struct Case {
    std::string_view scheme, setting, choice;
    double value;
    int order;
    double h;
  };
  for (const auto& [scheme, setting, choice, value, order, step] :
       {Case{"contact_symplectic_euler", "", "", 0, 1, 0.01}, Case{"contact_leapfrog", "", "", 0, 2, 0.05},
        Case{"contact_splitting", "splitting", "plain", 0, 2, 0.05},
        Case{"contact_splitting", "splitting", "merged", 0, 2, 0.05},
        Case{"contact_variational_midpoint", "", "", 0, 2, 0.05}, Case{"contact_galerkin_4", "", "", 0, 4, 0.1},
        Case{"contact_leapfrog", "composition", "suzuki_4", 0, 4, 0.1},
        Case{"contact_splitting", "composition", "kahan_li_6", 0, 6, 0.2},
        Case{"contact_gauss", "stages", "", 1, 2, 0.05}, Case{"contact_gauss", "stages", "", 2, 4, 0.1},
        Case{"contact_gauss", "stages", "", 3, 6, 0.2}, Case{"runge_kutta_4", "", "", 0, 4, 0.05}})
    for (const char* problem : {"damped_oscillator", "driven_oscillator", "modulated_oscillator", "damped_pendulum",
                                "scalar_field_cosmology"}) {
      const auto coarse = residuals(problem, scheme, setting, value, choice, step);
      const auto fine = residuals(problem, scheme, setting, value, choice, step / 2);
      EXPECT_GT(std::log2(coarse.decay / fine.decay), order - 0.35)
          << problem << ' ' << scheme << ' ' << choice << value;
      EXPECT_GT(fine.decay, 1e-13) << problem << ' ' << scheme << ": below round-off nothing is measured";
    }
  // The volume H^−(n+1) η∧(dη)ⁿ over one step, where H does not depend on time.
  for (const char* problem : {"damped_pendulum", "scalar_field_cosmology", "cosmological_oscillator"})
    for (const char* scheme : {"contact_leapfrog", "contact_splitting", "contact_galerkin_4"}) {
      const int order = scheme == std::string_view("contact_galerkin_4") ? 4 : 2;
      const double ratio =
          residuals(problem, scheme, "", 0, "", 0.1).volume / residuals(problem, scheme, "", 0, "", 0.05).volume;
      EXPECT_NEAR(std::log2(ratio), order + 1, 0.4) << problem << ' ' << scheme;
    }
}

// ---- heat

TEST(ContactStructure, GenericOscillatorKeepsItsEnergyAndItsEntropyNeverFalls) {
  const auto run = [](std::string_view scheme, std::string_view composition, double h, double gamma, int steps = 500,
                      double heat = 1) {
    Request request = runs::defaults("generic_oscillator", scheme);
    runs::begin(request, "U", heat);
    runs::set(request, "step", h);
    runs::set(request, "gamma", gamma);
    if (!composition.empty()) runs::set(request, "composition", composition);
    request.end = steps * h;
    runs::ask(request, "energy");
    runs::ask(request, "entropy");
    return runs::go(request).outcome.diagnostics;
  };
  const auto monotone = [](const std::vector<Report>& reports) {
    for (const auto& report : reports)
      if (report.key == "entropy")
        for (const auto& entry : std::get<std::vector<Report>>(report.value))
          if (entry.key == "monotone") return std::get<bool>(entry.value);
    throw std::out_of_range("entropy/monotone");
  };
  for (const auto composition : compositions::names)
    for (const double gamma : {0.0, 0.1, 2.0}) {
      const auto reports = run("contact_splitting", composition, 0.1, gamma);
      EXPECT_LT(runs::number(reports, "energy/max_abs_error"), 5e-13) << composition << ' ' << gamma;
      EXPECT_TRUE(monotone(reports)) << composition << ' ' << gamma;
      EXPECT_EQ(runs::number(reports, "entropy/final") > runs::number(reports, "entropy/initial"), gamma > 0);
    }
  EXPECT_GT(runs::number(run("runge_kutta_4", "", 0.1, 0.1), "energy/max_abs_error"), 1e-8);
  // Where γh is large entropy may fall: a negative stage of the composition cools.
  EXPECT_FALSE(monotone(run("contact_splitting", "yoshida_4", 1, 5, 10, 1e6)));
}

// ---- the slope of a van der Pol orbit

// The default slope is that of the flow, v̇/v, with a pole wherever the orbit turns.
TEST(ContactStructure, SlopeOfTheFlow) {
  Request request = runs::defaults("van_der_pol", "contact_splitting");
  runs::set(request, "composition", "kahan_li_8");
  runs::show_all(request);
  runs::ask(request, "poles");
  const auto result = runs::go(request);
  std::size_t turns = 0;
  for (std::size_t k = 1; k < result.rows.size(); ++k) {
    const double x = result.rows[k][1], v = result.rows[k][2], truth = (1 - x * x) - x / v;
    EXPECT_NEAR(result.rows[k][3], truth, 1e-9 * (1 + truth * truth)) << result.rows[k][0];
    turns += k > 1 && (v < 0) != (result.rows[k - 1][2] < 0);
  }
  const auto& poles = runs::list(result.outcome.diagnostics, "poles");
  EXPECT_GE(turns, 8U);
  EXPECT_EQ(std::ranges::count_if(poles, [](double t) { return t > 0; }), long(turns));  // the start is a pole, too
}

}  // namespace
