// lifted_splitting on equations alone: its orders, reversal, the derivative of a step (with which contact elements are
// transported), volumes, and what it refuses.
#include "core/schemes/flow_lift.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <tuple>
#include <utility>

#include "core/catalogue/found_schemes.hpp"
#include "core/number/linear.hpp"
#include "tests/support/steps_of_text.hpp"

namespace flow_lift {
namespace {

using namespace texts;

struct Flow {
  const char* name;
  Definition definition;
  std::vector<double> start;
  std::size_t parts;
};
Flow lorenz() {
  return {"lorenz",
          flow({"x", "y", "z"}, {{"sigma", 10}, {"rho", 28}, {"beta", 8.0 / 3}},
               {{"x", "sigma*(y - x)"}, {"y", "x*(rho - z) - y"}, {"z", "x*y - beta*z"}}),
          {1, 1, 1},
          3};
}
Flow van_der_pol() {
  return {"van_der_pol",
          flow({"x", "v"}, {{"epsilon", 1}}, {{"x", "v"}, {"v", "epsilon*(1 - x^2)*v - x + cos(t)/3"}}),
          {1, 0.2},
          2};
}
/// In the plane of Liénard, ẋ depends on x to the fifth power.
Flow lienard() {
  return {"lienard",
          flow({"x", "y"}, {{"e", 0.5}}, {{"x", "y - e*(0.8*x - 4*x^3/3 + 0.32*x^5)"}, {"y", "-x"}}),
          {1.3, 0},
          2};
}
/// Two coupled pendulums: all positions are one part, and all velocities another.
Flow swings() {
  return {"swings",
          flow({"x", "vx", "y", "vy"}, {}, {{"x", "vx"}, {"vx", "-sin(x) + y/5"}, {"y", "vy"}, {"vy", "-y^3 + x/5"}}),
          {1, 0, 0.5, 0.3},
          2};
}
/// One variable, whose rate depends on itself.
Flow alone() { return {"alone", flow({"x"}, {}, {{"x", "sin(x)*cos(t) - x^3/5"}}), {0.7}, 1}; }
std::vector<Flow> flows() { return {lorenz(), van_der_pol(), lienard(), swings(), alone()}; }

text::FlowParts parts_of(const Definition& definition) {
  const auto mechanics = mechanics_of(definition);
  return std::get<text::FlowParts>(text::flow_parts(*mechanics->text()->form, parameters_of(definition)));
}
Request request_of(const Flow& of, std::string_view scheme, double step, double end) {
  Request request = request_by(scheme, mechanics_of(of.definition), of.start, end);
  if (schemes()[request.scheme].find("step")) runs::set(request, "step", step);
  return request;
}
std::vector<double> after_step(const text::FlowParts& flow, const LiftedSplitting& scheme, std::vector<double> x,
                               std::vector<double>& derivative) {
  const std::size_t n = x.size();
  const auto shared = std::make_shared<const text::FlowParts>(flow);
  derivative.assign(n * n, 0);
  std::vector<Slope> y;
  for (std::size_t j = 0; j < n; ++j) {
    y.assign(x.begin(), x.end());
    y[j].slope[0] = 1;
    FlowLift<Slope> stepper(shared, scheme);
    stepper.begin(y.data(), 0.3);
    EXPECT_EQ(stepper.step(y.data(), 0.3, scheme.step), StepStatus::ok);
    for (std::size_t i = 0; i < n; ++i) derivative[i * n + j] = y[i].slope[0];
  }
  for (std::size_t i = 0; i < n; ++i) x[i] = y[i].value;
  return x;
}

class FlowLiftOf : public testing::TestWithParam<Flow> {
 protected:
  const Flow& tested() const { return GetParam(); }
};

TEST_P(FlowLiftOf, HasTheOrderOfTheComposition) {
  constexpr double end = 0.75;
  Request truth = request_of(tested(), "taylor", 0, end);
  runs::set(truth, "tolerance", 1e-16);
  const auto known = final_of(truth);
  int looked = 0;
  for (const char* lift : {"automatic", "midpoint", "extrapolation"})
    for (const auto& [composition, order] : {std::pair{"none", 2},
                                             {"suzuki_4", 4},
                                             {"yoshida_6", 6},
                                             {"kahan_li_6", 6},
                                             {"kahan_li_8", 8},
                                             {"sofroniou_spaletta_10", 10}}) {
      // Extrapolations are sums of large terms and round more, and Lorenz's equations let errors grow.
      const bool sums = lift == std::string("extrapolation");
      const double rounding = sums ? 1e-9 : 1e-12;
      double seen = unknown, before = 1;
      for (int n = 1; n <= 8192 && before > rounding; n *= 2) {
        Request request = request_of(tested(), "lifted_splitting", end / n, end);
        runs::set(request, "composition", composition);
        runs::set(request, "lift", lift);
        const auto outcome = runs::go(request).outcome;
        if (outcome.stop.reason != ReturnCode::completed) continue;  // these steps are too long
        const double error = distance(final_of(request), known);
        if (before < 1e-3 && error > rounding) seen = std::log2(before / error);
        before = error;
      }
      if (std::isnan(seen)) {
        EXPECT_GE(order, sums ? 6 : 8) << "no two steps between 1e-3 and round-off: " << composition << " " << lift;
        continue;
      }
      ++looked;
      const double near = order < 8 ? 0.35 : 1.5;
      EXPECT_GT(seen, order - near) << composition << " " << lift;
      // Where nothing is split the errors at first are those of the extrapolation, which has a higher order; at order
      // 10 the last step above round-off may be too long to show the order.
      if (!sums && order < 10) {
        EXPECT_LT(seen, order + near) << composition << " " << lift;
      }
    }
  EXPECT_GE(looked, 8);
}

TEST_P(FlowLiftOf, ReturnsByTheStepsItCameBy) {
  const auto parts = std::make_shared<const text::FlowParts>(parts_of(tested().definition));
  for (const Composition::Name composition : {Composition::none, Composition::kahan_li_6}) {
    constexpr double h = 0.02;
    const auto went = there_and_back(FlowLift<double>(parts, {h, composition}), tested().start, 0.3, h, 20);
    EXPECT_GT(went.away, 1e-2);
    EXPECT_LT(went.missed, 1e-11);
  }
}

// Contact elements are transported by the derivative of a step: the derivative by dual numbers agrees with differences
// of whole steps, within their error.
TEST_P(FlowLiftOf, HasTheDerivativeOfItsOwnSteps) {
  const text::FlowParts flow = parts_of(tested().definition);
  const LiftedSplitting scheme{0.05, Composition::kahan_li_6};
  const std::size_t n = tested().start.size();
  std::vector<double> derivative, other;
  after_step(flow, scheme, tested().start, derivative);
  constexpr double aside = 1e-5;
  for (std::size_t j = 0; j < n; ++j) {
    std::vector<double> below = tested().start, above = below;
    below[j] -= aside;
    above[j] += aside;
    below = after_step(flow, scheme, below, other);
    above = after_step(flow, scheme, above, other);
    for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(derivative[i * n + j], (above[i] - below[i]) / (2 * aside), 1e-8);
  }
}

TEST_P(FlowLiftOf, IsTheSameHoweverItIsRecorded) {
  expect_the_same_however_recorded(request_of(tested(), "lifted_splitting", 0.01, 1.004));
}

TEST_P(FlowLiftOf, HasAsFewPartsAsItsRatesAllow) {
  EXPECT_EQ(parts_of(tested().definition).parts.size(), tested().parts);
}

INSTANTIATE_TEST_SUITE_P(, FlowLiftOf, testing::ValuesIn(flows()),
                         [](const auto& tested) { return tested.param.name; });

// Each part of Lorenz's equations has a constant divergence, −(σ + 1 + β) together: volumes contract by the true factor
// at any step. Steps by Runge–Kutta or by the midpoint rule of the whole do not do that.
TEST(FlowLift, ContractsVolumesAsLorenzDoes) {
  const text::FlowParts flow = parts_of(lorenz().definition);
  std::vector<double> derivative;
  for (const double step : {0.1, 0.01}) {
    const double factor = std::exp(-(10 + 1 + 8.0 / 3) * step);
    after_step(flow, {step, Composition::none}, {1, 2, 20}, derivative);
    EXPECT_NEAR(detail::determinant_by_lu(3, derivative.data()) / factor, 1, 1e-13);
    after_step(flow, {step, Composition::none, LiftMethod::midpoint}, {1, 2, 20}, derivative);
    EXPECT_GT(std::abs(detail::determinant_by_lu(3, derivative.data()) / factor - 1), 1e-7);
  }
}

// For ẋ = v, v̇ = f(x) the parts are a drift and a kick.
TEST(FlowLift, OfASeparableMotionIsLeapfrog) {
  const Flow pendulum{"pendulum", flow({"q", "v"}, {}, {{"q", "v"}, {"v", "-sin(q)"}}), {1, 0.2}, 2};
  Request request = request_of(pendulum, "lifted_splitting", 0.1, 10);
  const auto found = final_of(request);
  double q = 1, v = 0.2;
  for (int i = 0; i < 100; ++i) {
    q += 0.05 * v;
    v -= 0.1 * std::sin(q);
    q += 0.05 * v;
  }
  EXPECT_NEAR(found[0], q, 1e-13);
  EXPECT_NEAR(found[1], v, 1e-13);
}

// The motion of x has the same bits as by the same scheme for H = p·X, which carries p along and keeps the symplectic
// form.
TEST(FlowLift, IsTheMotionOfALiftWithoutItsMomenta) {
  const Definition whole =
      of(Definition::Kind::hamiltonian, {"x", "v"}, {{"epsilon", 1}}, "px*v + pv*(epsilon*(1 - x^2)*v - x + cos(t)/3)");
  for (const char* lift : {"midpoint", "extrapolation"}) {
    Request request = request_of(van_der_pol(), "lifted_splitting", 0.1, 5),
            with_momenta =
                request_by("lifted_splitting", mechanics_of(whole), std::vector<double>{1, 0.2, 0.3, 0.2}, 5);
    runs::set(with_momenta, "step", 0.1);
    runs::ask(with_momenta, "structure");
    for (Request* one : {&request, &with_momenta}) {
      runs::set(*one, "lift", lift);
      runs::set(*one, "composition", "kahan_li_6");
    }
    const auto alone = final_of(request);
    const auto outcome = runs::go(with_momenta).outcome;
    EXPECT_EQ(alone[0], outcome.final[0]) << lift;
    EXPECT_EQ(alone[1], outcome.final[1]) << lift;
    EXPECT_LT(runs::number(outcome.diagnostics, "structure/max_defect"), 1e-13) << lift;
  }
}

// Linear equations with constant coefficients are exact at any step.
TEST(FlowLift, OfLinearEquationsIsExact) {
  const Flow spiral{"spiral", flow({"x", "y"}, {{"a", 0.1}}, {{"x", "y - a*x + 1"}, {"y", "-x"}}), {1.3, 0}, 2};
  Request truth = request_of(spiral, "taylor", 0, 20);
  runs::set(truth, "tolerance", 1e-16);
  EXPECT_LT(distance(final_of(request_of(spiral, "lifted_splitting", 5, 20)), final_of(truth)), 1e-13);
  Request whole = request_of(spiral, "lifted_splitting", 5, 20);
  runs::set(whole, "lift", "exact");
  EXPECT_EQ(final_of(whole), final_of(request_of(spiral, "lifted_splitting", 5, 20)));
}

TEST(FlowLift, SaysWhatItDoesNotTake) {
  const auto stop_of = [](const Flow& of, const char* lift) {
    Request request = request_of(of, "lifted_splitting", 0.01, 1);
    runs::set(request, "lift", lift);
    return runs::go(request).outcome.stop.detail.text();
  };
  EXPECT_NE(stop_of(lorenz(), "exact").find("linear with constant coefficients"), std::string::npos)
      << stop_of(lorenz(), "exact");
  Flow chain{"chain", flow({}, {}, {}), {1}, 2};
  const auto make = [&](int n) {
    chain.definition = flow({}, {}, {});
    for (int i = 0; i < n; ++i) {
      const std::string own = "x" + std::to_string(i), next = "x" + std::to_string((i + 1) % n);
      chain.definition.variables.push_back(own);
      chain.definition.equations.emplace_back(own, next + " - " + own + "^3");
    }
  };
  make(100);
  EXPECT_NE(stop_of(chain, "midpoint").find("only the lift automatic"), std::string::npos);
  Request request = request_of(chain, "lifted_splitting", 0.01, 1), truth = request_of(chain, "taylor", 0, 1);
  EXPECT_LT(distance(final_of(request), final_of(truth)), 1e-4) << "of any lift, part by part";
  make(300);
  const auto mechanics = mechanics_of(chain.definition);
  EXPECT_FALSE(runs::fits(mechanics->card(), find_scheme("lifted_splitting").value()));
  EXPECT_NE(objection_to_scheme({mechanics, {}, {}, 0}, "lifted_splitting").find("more than 256 variables"),
            std::string::npos);
}

// Steps of problems of the catalogue are made from their rates, with the parameters of the request. Where each of the
// problem's own flows moves one variable, the map is the same as the splitting into those flows.
TEST(FlowLiftOfTheCatalogue, IsTheSplittingOfTheFlowsOfAProblem) {
  for (const auto& [id, parameter, value] : {std::tuple{"van_der_pol", "epsilon", 3.0}, {"lorenz", "rho", 20.0}})
    for (const char* composition : {"none", "kahan_li_6"}) {
      Request lifted = runs::defaults(id, "lifted_splitting"), split = runs::defaults(id, "contact_splitting");
      for (Request* one : {&lifted, &split}) {
        runs::set(*one, "step", 0.02);
        runs::set(*one, "composition", composition);
        runs::set(*one, parameter, value);
        one->end = 2.011;
        runs::only_final(*one);
      }
      const auto a = final_of(lifted), b = final_of(split);
      for (std::size_t i = 0; i < a.size(); ++i) {
        if (std::isnan(b[i])) continue;  // the slope, which is not asked for here
        EXPECT_NEAR(a[i], b[i], 1e-11 * (1 + std::abs(b[i]))) << id << " " << composition;
      }
    }
}

TEST(FlowLiftOfTheCatalogue, HasTheOrderOfTheCompositionOnEveryFlow) {
  int flows = 0;
  for (const ProblemCard& card : runs::problem_cards()) {
    if (!runs::fits(card, find_scheme("lifted_splitting").value())) continue;
    ++flows;
    EXPECT_EQ(card.lift, Lifted::yes) << card.id;
    Request truth = runs::defaults(card.id, "taylor");
    runs::set(truth, "tolerance", 1e-16);
    truth.end = 0.5;
    runs::only_final(truth);
    const auto known = runs::go(truth).outcome.final;
    for (const auto& [composition, order] : {std::pair{"none", 2}, {"suzuki_4", 4}}) {
      const auto error = [&](double step) {
        Request request = runs::defaults(card.id, "lifted_splitting");
        runs::set(request, "step", step);
        runs::set(request, "composition", composition);
        request.end = truth.end;
        runs::only_final(request);
        const auto found = runs::go(request).outcome.final;
        double most = 0;
        for (std::size_t i = 0; i < found.size(); ++i)
          if (!std::isnan(found[i]) && !std::isnan(known[i])) most = std::max(most, std::abs(found[i] - known[i]));
        return most;
      };
      const double step = order == 2 ? 1.0 / 256 : 1.0 / 64;
      EXPECT_GT(error(step / 2), 1e-12) << card.id << ": round-off";
      EXPECT_NEAR(std::log2(error(step) / error(step / 2)), order, 0.35) << card.id << " " << composition;
    }
  }
  if (flows == 0) GTEST_SKIP() << "no flow of the catalogue is built";
}

// The slope of the contact element in the plane of x and v after a step (x, v) ↦ (Q, S̄) is (S̄_q + p S̄_s)/(Q_q + p
// Q_s).
TEST(FlowLiftOfTheCatalogue, TakesTheSlopeAlongByItsDerivative) {
  Request request = runs::defaults("van_der_pol", "lifted_splitting");
  runs::show_all(request);
  runs::set(request, "step", 0.1);
  runs::begin(request, "x", 1);
  runs::begin(request, "v", 0.2);
  runs::begin(request, "slope", 0.4);
  request.end = 0.1;
  const auto row = runs::go(request).rows.back();
  std::vector<double> m;
  const Flow typed{"typed", flow({"x", "v"}, {}, {{"x", "v"}, {"v", "(1 - x^2)*v - x"}}), {}, 2};
  const auto image = after_step(parts_of(typed.definition), {0.1, Composition::none}, {1, 0.2}, m);
  EXPECT_NEAR(row[1], image[0], 1e-15);
  EXPECT_NEAR(row[2], image[1], 1e-15);
  EXPECT_NEAR(row[3], (m[2] + 0.4 * m[3]) / (m[0] + 0.4 * m[1]), 1e-14);
}

}  // namespace
}  // namespace flow_lift
