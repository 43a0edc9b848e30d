// Errors of the contact schemes on oscillators, the perturbed Kepler problem and the Lane–Emden equation, against a
// table measured by an independent implementation of the same formulas. An error of the right size is a sharper test
// than a small one: it fails when a scheme is another scheme of the same order.
#include <gtest/gtest.h>

#include <cmath>

#include "core/schemes/list.hpp"
#include "least_problems.hpp"
#include "tests/support/contact_data.hpp"

namespace {

using namespace least;
using namespace least::problems;
using contact::data, contact::pi, contact::request_for;

/// The k-th reference orbit of a problem at the time t.
std::vector<double> reference(const std::string& problem, std::size_t k, double t) {
  for (const auto& state : contact::orbits(problem).at(k)->at("states"))
    if (std::stod(state.at("t").get<std::string>()) == t) {
      std::vector<double> x;
      for (const auto& number : state.at("state")) x.push_back(std::stod(number.get<std::string>()));
      return x;
    }
  throw std::out_of_range(problem);
}

std::vector<double> final_of(Request request, double end) {
  request.end = end;
  runs::only_final(request);
  const auto result = runs::go(request);
  EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed) << result.outcome.stop.detail;
  return result.outcome.final;
}

// ---- modulated_oscillator: a = 0.5, Ω = π, from (1, 0, 0.2)

/// Σ|Δ| over q, p, s at t = 5.
double modulated_error(std::string_view scheme, std::string_view composition, double h) {
  Request request = request_for("modulated_oscillator", scheme, composition, h);
  runs::show_all(request);
  const auto x = final_of(request, 5), truth = reference("modulated_oscillator", 0, 5);
  double sum = 0;
  for (std::size_t i = 0; i < 3; ++i) sum += std::abs(x[i] - truth[i]);
  return sum;
}
TEST(ContactTable, ModulatedOscillator) {
  const auto check = [](std::string_view scheme, std::string_view composition, double expected) {
    EXPECT_NEAR(modulated_error(scheme, composition, 0.1) / expected, 1, 0.02) << scheme << ' ' << composition;
  };
  check("contact_splitting", "none", 3.63e-3);
  check("contact_leapfrog", "none", 4.59e-3);
  check("contact_splitting", "suzuki_4", 1.44e-6);
  check("contact_splitting", "kahan_li_6", 1.49e-8);
  EXPECT_LT(modulated_error("contact_splitting", "kahan_li_8", 0.1), 1e-11);
}
// A scheme that evaluates α at a wrong time of the step is of order 1.
TEST(ContactTable, DampingInTimeIsReadAtTheProperEnds) {
  for (const char* scheme : {"contact_leapfrog", "contact_splitting", "contact_variational_midpoint"})
    for (const double h : {0.05, 0.025, 0.0125}) {
      const double order = std::log2(modulated_error(scheme, "", h) / modulated_error(scheme, "", h / 2));
      EXPECT_GE(order, 1.95) << scheme << ' ' << h;
      EXPECT_LE(order, 2.05) << scheme << ' ' << h;
    }
}

// ---- perturbed_kepler: α = 0.01, Ω = π, e = 0.5

TEST(ContactTable, PerturbedKepler) {
  const auto truth = reference("perturbed_kepler", 1, 10);
  const auto error = [&](std::string_view scheme, std::string_view composition, double h) {
    const auto x = final_of(request_for("perturbed_kepler", scheme, composition, h), 10);
    return std::hypot(x[0] - truth[0], x[1] - truth[1]) / std::hypot(truth[0], truth[1]);
  };
  struct Row {
    std::string_view scheme, composition;
    double expected[3];
  };
  for (const auto& [scheme, composition, expected] :
       {Row{"contact_splitting", "none", {9.7e-2, 2.46e-2, 6.2e-3}},
        Row{"contact_leapfrog", "none", {0.228, 5.7e-2, 1.4e-2}}, Row{"runge_kutta_4", "", {3.4e-3, 1.5e-4, 7.5e-6}},
        Row{"contact_splitting", "suzuki_4", {2.1e-4, 1.3e-5, 8.2e-7}},
        Row{"contact_splitting", "yoshida_6", {6.4e-5, 1.07e-6, 1.7e-8}},
        Row{"contact_splitting", "kahan_li_6", {2.5e-6, 4.1e-8, 6.4e-10}}}) {
    double h = 0.1;
    for (const double e : expected) {
      EXPECT_NEAR(error(scheme, composition, h) / e, 1, 0.05) << scheme << ' ' << composition << ' ' << h;
      h /= 2;
    }
  }
  EXPECT_NEAR(error("contact_splitting", "kahan_li_8", 0.1) / 7.9e-10, 1, 0.05);
  EXPECT_LT(error("contact_splitting", "kahan_li_8", 0.05), 1e-11);
}

/// there_and_back() returns the distance from the start after `steps` steps of length h and as many back.
template <class Scheme>
double there_and_back(const Scheme& scheme, int steps, double h) {
  const PerturbedKepler<> problem;
  using X = FullStateOf<PerturbedKepler<>>;
  X start;
  start.q = {0.5, 0};
  start.p = {0, std::sqrt(3.0)};
  X x = start;
  auto stepper = scheme.bind(problem, x);
  for (int n = 0; n < steps; ++n) {
    x.t = n * h;
    EXPECT_EQ(stepper.step(x, h), StepStatus::ok);
  }
  for (int n = steps; n > 0; --n) {
    x.t = n * h;
    EXPECT_EQ(stepper.step(x, -h), StepStatus::ok);
  }
  double most = 0;
  for (std::size_t i = 0; i < X::size; ++i) most = std::max(most, std::abs(x[i] - start[i]));
  return most;
}
TEST(ContactTable, ThereAndBackAgain) {
  const double h = 0.05;
  EXPECT_LT(there_and_back(ContactLeapfrog{h}, 2000, h), 1e-11);
  for (std::size_t c = 0; c < compositions::names.size(); ++c) {
    const auto composition = static_cast<Composition>(c);
    EXPECT_LT(there_and_back(ContactLeapfrog{h, composition}, 2000, h), 1e-9) << compositions::names[c];
    EXPECT_LT(there_and_back(ContactSplitting{h, composition}, 2000, h), 1e-9) << compositions::names[c];
    EXPECT_LT(there_and_back(ContactSplitting{h, composition, Splitting::merged}, 2000, h), 1e-9)
        << compositions::names[c];
  }
  EXPECT_LT(there_and_back(ContactVariationalMidpoint{h}, 2000, h), 1e-9);
  EXPECT_LT(there_and_back(ContactGauss{h, 3}, 2000, h), 1e-9);
  EXPECT_GT(there_and_back(RungeKutta4{h}, 2000, h), 1e-6);       // not symmetric
  EXPECT_GT(there_and_back(ContactGalerkin4{h}, 2000, h), 1e-7);  // symmetric without s only
}

// ---- damped_oscillator: from (−0.25, 0.75), h = 0.1

/// Largest |Δq| along the run.
double damped_error(std::string_view scheme, double alpha, double end) {
  Request request = request_for("damped_oscillator", scheme, "", 0.1);
  runs::set(request, "damping", alpha);
  request.end = end;
  const auto result = runs::go(request);
  EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed);
  const DampedOscillator<> problem{1, alpha};
  double most = 0;
  for (const auto& row : result.rows) {
    const auto exact = problem.exact(State<1>{0, {-0.25}, {0.75}, {}}, row[0]);
    most = std::max(most, std::abs(row[1] - exact.q[0]));
  }
  return most;
}
TEST(ContactTable, DampedOscillator) {
  struct Row {
    std::string_view scheme;
    double weak, strong;  ///< α = 0.01 up to t = 50, α = 1 up to t = 15
  };
  for (const auto& [scheme, weak, strong] :
       {Row{"explicit_euler", 6.5, 2.7e-2}, Row{"explicit_midpoint", 4.9e-2, 9.6e-4},
        Row{"runge_kutta_4", 2.5e-5, 4.4e-7}, Row{"contact_leapfrog", 1.26e-2, 4.28e-4},
        Row{"contact_splitting", 1.21e-2, 4.38e-4}}) {
    EXPECT_NEAR(damped_error(scheme, 0.01, 50) / weak, 1, 0.02) << scheme;
    EXPECT_NEAR(damped_error(scheme, 1, 15) / strong, 1, 0.02) << scheme;
  }
}
// H e^{αt} is conserved: contact schemes keep it, and a scheme of the same order without the structure loses it in
// proportion to time. The midpoint rule, which conserves quadratic energies without damping, does better.
TEST(ContactTable, DampedOscillatorKeepsTheDecayOfItsEnergy) {
  const auto residual = [](std::string_view scheme, double end) {
    Request request = request_for("damped_oscillator", scheme, "", 0.1);
    request.end = end;
    runs::ask(request, "decay");
    runs::only_final(request);
    return runs::number(runs::go(request).outcome.diagnostics, "decay/max_residual");
  };
  for (const char* scheme : {"contact_leapfrog", "contact_splitting"})
    for (const double end : {10.0, 100.0}) {
      EXPECT_GT(residual(scheme, end), 2.2e-3 * 0.98) << scheme << ' ' << end;
      EXPECT_LT(residual(scheme, end), 2.6e-3 * 1.02) << scheme << ' ' << end;
    }
  EXPECT_LT(residual("contact_variational_midpoint", 100), 2e-4);
  EXPECT_NEAR(residual("explicit_midpoint", 100) / residual("explicit_midpoint", 10), 10, 1);
}
// α = 100, h = 0.1: the merged splitting follows the slow motion, the plain one does not.
TEST(ContactTable, StrongDampingNeedsTheMergedSplitting) {
  const auto error = [](std::string_view splitting, double q, double p) {
    Request request = request_for("damped_oscillator", "contact_splitting", "none", 0.1);
    runs::set(request, "splitting", splitting);
    runs::set(request, "damping", 100);
    runs::begin(request, "q", q);
    runs::begin(request, "p", p);
    const double truth = DampedOscillator<>{1, 100}.exact(State<1>{0, {q}, {p}, {}}, 50.0).q[0];
    return std::abs(final_of(request, 50)[0] / truth - 1);
  };
  EXPECT_LT(error("merged", 1, 0), 3e-4);
  EXPECT_EQ(error("automatic", 1, 0), error("merged", 1, 0));
  EXPECT_NEAR(error("plain", 1, 0), 0.87, 0.01);
  EXPECT_NEAR(error("merged", -0.25, 0.75), 0.12, 0.01);  // the initial layer is not resolved
}

// ---- lane_emden

/// Largest |Δq| along a run from t = 0 with h = 0.01.
double lane_emden_error(std::string_view scheme, double n, double end) {
  Request request = request_for("lane_emden", scheme, "none", 0.01);
  runs::set(request, "n", n);
  runs::set(request, "after_zero", "continue");
  request.end = end;
  const auto result = runs::go(request);
  EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed);
  const LaneEmden<> problem{n, AfterZero::continue_};
  double most = 0;
  for (const auto& row : result.rows)
    most = std::max(most, std::abs(row[1] - problem.exact(State<1>{0, {1}, {0}, {}}, row[0]).q[0]));
  return most;
}
TEST(ContactTable, LaneEmdenFromTheSingularStart) {
  EXPECT_NEAR(lane_emden_error("contact_splitting", 0, 2.4) / 1.3e-4, 1, 0.04);
  EXPECT_NEAR(lane_emden_error("contact_splitting", 1, 10) / 9.4e-5, 1, 0.02);
  EXPECT_NEAR(lane_emden_error("contact_splitting", 5, 30) / 7.9e-5, 1, 0.02);
  EXPECT_LT(lane_emden_error("contact_leapfrog", 0, 2.4), 2e-15);
  EXPECT_NEAR(lane_emden_error("contact_leapfrog", 1, 10) / 4.4e-6, 1, 0.02);
  EXPECT_NEAR(lane_emden_error("contact_leapfrog", 5, 30) / 3.7e-6, 1, 0.02);
}
TEST(ContactTable, LaneEmdenByAComposition) {
  const auto error = [](double h) {
    Request request = request_for("lane_emden", "contact_splitting", "kahan_li_6", h);
    runs::set(request, "n", 5);
    const auto exact = [](double t) { return LaneEmden<>{5}.exact(State<1>{0, {1}, {0}, {}}, t); };
    runs::begin(request, "t", 0.5);
    runs::begin(request, "q", exact(0.5).q[0]);
    runs::begin(request, "p", exact(0.5).p[0]);
    const auto x = final_of(request, 5);
    return std::hypot(x[0] - exact(5).q[0], x[1] - exact(5).p[0]);
  };
  EXPECT_NEAR(error(0.05) / 6.6e-11, 1, 0.1);
  EXPECT_NEAR(std::log2(error(0.1) / error(0.05)), 6, 0.3);
}
TEST(ContactTable, LaneEmdenZeros) {
  for (const auto& polytrope : data().at("lane_emden")) {
    if (polytrope.at("first_zero").is_null()) continue;
    const double truth = std::stod(polytrope.at("first_zero").get<std::string>());
    const double n = polytrope.at("n");
    for (const char* after : {"stop", "signed"}) {
      Request request = request_for("lane_emden", "contact_splitting", "kahan_li_8", 0.01);
      runs::set(request, "n", n);
      runs::set(request, "after_zero", after);
      runs::ask(request, "zeros");
      runs::only_final(request);
      request.end = truth + 0.5;
      const auto result = runs::go(request);
      const auto& zeros = runs::list(result.outcome.diagnostics, "zeros");
      ASSERT_EQ(zeros.size(), 1U) << n << ' ' << after;
      EXPECT_NEAR(zeros[0], truth, 1e-10) << n << ' ' << after;
      if (after == std::string("stop")) {
        EXPECT_EQ(result.outcome.stop.reason, ReturnCode::left_domain);
        EXPECT_EQ(result.outcome.stop.singular_at, zeros[0]);
      }
    }
  }
}

}  // namespace
