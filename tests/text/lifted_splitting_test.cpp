// lifted_splitting: its order with every setting of `lift`, the symplectic or contact form to round-off, reversal, and
// which Hamiltonians can be lifted.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>

#include "core/catalogue/found_backend.hpp"
#include "core/catalogue/sized_mechanics.hpp"
#include "core/run/columns.hpp"
#include "core/run/run.hpp"
#include "core/schemes/list.hpp"
#include "core/text/scenes.hpp"
#include "tests/support/lifted.hpp"

namespace lifted {
namespace {

class OfScene : public testing::TestWithParam<Scene> {
 protected:
  const Scene& scene() const { return GetParam(); }
  std::shared_ptr<const Mechanics> mechanics = mechanics_of(GetParam().definition);
};

// The orders of the compositions, from both sides, between a coarse step and round-off. The midpoint rule of order 2
// supports all of them, because it is symmetric. Extrapolations are sums of large terms and round more.
TEST_P(OfScene, HasTheOrderOfTheComposition) {
  constexpr double end = 3;
  const auto truth = end_of(composed(request_of(scene(), mechanics, end / 2000, end), "kahan_li_8"));
  ASSERT_LT(distance(truth, end_of(request_of(scene(), mechanics, 0, end, "taylor"))), 1e-10);
  int looked = 0;
  for (const char* lift : {"automatic", "extrapolation"})
    for (const auto& [composition, order] : {std::pair{"none", 2},
                                             {"yoshida_4", 4},
                                             {"suzuki_4", 4},
                                             {"kahan_li_6", 6},
                                             {"kahan_li_8", 8},
                                             {"sofroniou_spaletta_10", 10}}) {
      const double rounding = std::string_view(lift) == "extrapolation" ? 3e-10 : 1e-11;
      double seen = unknown, before = 1;
      for (int n = 8; n <= 4096 && before > rounding; n *= 2) {
        const double error =
            distance(truth, end_of(composed(request_of(scene(), mechanics, end / n, end), composition, lift)));
        if (before < 1e-3 && error > rounding) seen = std::log2(before / error);
        before = error;
      }
      if (std::isnan(seen)) {
        EXPECT_GE(order, 8) << "no two steps between 1e-3 and round-off: " << composition << " " << lift;
        continue;
      }
      ++looked;
      const double near = order < 8 ? 0.35 : 1.2;
      EXPECT_GT(seen, order - near) << composition << " " << lift;
      // Where nothing is split the errors at first are those of the extrapolation, which has a higher order.
      if (scene().name != std::string_view("van_der_pol")) {
        EXPECT_LT(seen, order + near) << composition << " " << lift;
      }
    }
  EXPECT_GE(looked, 8);
}

TEST_P(OfScene, KeepsTheFormToRoundOff) {
  for (const char* lift : {"automatic", "midpoint", "extrapolation"})
    for (const char* composition : {"none", "kahan_li_6"}) {
      Request request = composed(request_of(scene(), mechanics, 0.1, 2), composition, lift);
      runs::ask(request, "structure");
      const auto outcome = runs::go(request).outcome;
      ASSERT_EQ(outcome.stop.reason, ReturnCode::completed) << outcome.stop.detail;
      const double defect = runs::number(outcome.diagnostics, "structure/max_defect");
      EXPECT_LT(defect, 1e-13) << lift;
      EXPECT_FALSE(std::isnan(defect));
    }
  Request other = request_of(scene(), mechanics, 0.1, 2, "runge_kutta_4");
  runs::ask(other, "structure");
  EXPECT_GT(runs::number(runs::go(other).outcome.diagnostics, "structure/max_defect"), 1e-9);
}

// Where the lifted flow is approximated symmetrically a run returns by the same steps; with extrapolation it does not.
TEST_P(OfScene, ReturnsByTheStepsItCameBy) {
  text::HamiltonianScene problem;
  const Request request = request_of(scene(), mechanics, 0.1, 1);
  problem.formulas = std::make_shared<text::Formulas>(*mechanics->text()->form, request.scene->parameters);
  StateOf<text::HamiltonianScene> start{};  // has room for more coordinates, which rest
  start.t = 0.3;
  const auto& initial = request.scene->initial;
  for (std::size_t i = 0, n = problem.coordinates(); i < n; ++i) {
    start.q[i] = initial[i];
    start.p[i] = initial[n + i];
  }
  if (problem.reads_action()) start.action.s = initial.back();
  const auto missed = [&](const LiftedSplitting& scheme) {
    auto x = start;
    auto stepper = scheme.bind(problem, x);
    for (const double h : {0.1, -0.1})
      for (int i = 0; i < 10; ++i) {
        EXPECT_EQ(stepper.step(x, h), StepStatus::ok);
        x.t += h;
      }
    double most = 0;
    for (std::size_t i = 0; i < x.size; ++i) most = std::max(most, std::abs(x[i] - start[i]));
    return most;
  };
  EXPECT_LT(missed({0.1, Composition::none, LiftMethod::automatic}), 2e-14);
  EXPECT_LT(missed({0.1, Composition::kahan_li_6, LiftMethod::midpoint}), 2e-13);
  EXPECT_GT(missed({0.1, Composition::none, LiftMethod::extrapolation}), 1e-7);
}

// A run on the parts that the scheme finds in the Hamiltonian, as in a problem of the catalogue, equals the run of the
// scene.
TEST_P(OfScene, IsTheSameWhereItIsFound) {
  for (const char* lift : {"automatic", "extrapolation"}) {
    const Request request = composed(request_of(scene(), mechanics, 0.05, 2.01), "suzuki_4", lift);
    const auto found = lifted_splitting_found().look(*mechanics->text(), request.scene->parameters);
    ASSERT_EQ(found->objection(), "");
    const FoundBackend problem(mechanics->backend(request), found);
    Samples samples;
    const std::atomic<bool> cancelled{false};
    const auto columns = columns_of(problem.table().traits, mechanics->card());
    std::vector<double> end = least::run(problem, request, columns, samples, cancelled).final;
    const auto& variables = mechanics->card().variables;
    std::vector<double> shown;
    for (std::size_t i = 0; i < variables.size(); ++i)
      if (!variables[i].hidden) shown.push_back(end[i]);
    EXPECT_EQ(shown, end_of(request)) << lift;
  }
}

TEST_P(OfScene, SaysWhetherTheLiftIsExact) {
  const ProblemCard& card = mechanics->card();
  EXPECT_EQ(card.lift, scene().exact ? Lifted::exactly : Lifted::yes);
  Request exact = composed(request_of(scene(), mechanics, 0.1, 1), "none", "exact");
  EXPECT_EQ(schemes()[exact.scheme].conflicts(exact.settings, card).empty(), scene().exact);
}

INSTANTIATE_TEST_SUITE_P(, OfScene, testing::ValuesIn(scenes()), [](const auto& tested) { return tested.param.name; });

// A step contracts the contact form by λ = e^{−∫H_s dt}, up to the error of the scheme: h³ a step at order 2.
TEST(LiftedSplitting, ContractsAsTheMotionDoes) {
  const Scene scene{"contact_prototype", contact_prototype(), {1, 0.5, 0.2}};
  const auto mechanics = mechanics_of(scene.definition);
  const auto wrong = [&](double step) {
    Request request = request_of(scene, mechanics, step, step);
    runs::ask(request, "structure");
    const double factor = runs::number(runs::go(request).outcome.diagnostics, "structure/factor");
    constexpr int parts = 100;
    Request path = composed(request_of(scene, mechanics, step / parts, step), "kahan_li_8");
    path.record = {Record::Mode::every, 1, {}};
    path.columns.clear();
    for (const char* name : {"q", "p", "s"})
      path.columns.push_back(runs::position(runs::card(path).columns, name, [](const auto& c) { return c.name; }));
    const auto rows = runs::go(path).rows;
    EXPECT_EQ(rows.size(), parts + 1U);
    double sum = 0;  // by Simpson's rule
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double q = rows[i][0], p = rows[i][1], s = rows[i][2];
      const double slope = 0.3 * p * std::sin(q) + 0.2 + 0.2 * s * std::cos(q);
      sum += (i == 0 || i == parts ? 1 : i % 2 ? 4 : 2) * slope * step / (3 * parts);
    }
    return std::abs(factor - std::exp(-sum));
  };
  EXPECT_LT(wrong(0.2), 1e-3);
  EXPECT_GT(wrong(0.1), 1e-8) << "above the errors of the quadrature";
  EXPECT_NEAR(std::log2(wrong(0.2) / wrong(0.1)), 3, 0.2);
}

// Jacobi's constant of an orbit about the heavier body, over a thousand rotations of the frame: its error stays
// bounded, but grows with Runge–Kutta steps of equal cost.
TEST(LiftedSplitting, KeepsJacobisConstant) {
  const Scene scene{"restricted_three_bodies", restricted_three_bodies(), {0.5, 0, 0, 1.2}};
  const auto mechanics = mechanics_of(scene.definition);
  const auto drift = [&](const char* scheme, double step, double end, const char* composition) {
    Request request = request_of(scene, mechanics, step, end, scheme);
    if (composition) runs::set(request, "composition", composition);
    runs::ask(request, "energy");
    return runs::number(runs::go(request).outcome.diagnostics, "energy/max_abs_error");
  };
  constexpr double turn = 2 * std::numbers::pi;
  const double early = drift("lifted_splitting", 0.04, 20 * turn, "suzuki_4"),
               late = drift("lifted_splitting", 0.04, 1000 * turn, "suzuki_4");
  EXPECT_LT(late, 2 * early);
  EXPECT_GT(drift("runge_kutta_4", 0.032, 1000 * turn, nullptr), 20 * late);  // 4 evaluations, not 5
}

TEST(LiftedSplitting, IsRefusedByTheNameOfTheTerm) {
  const auto offers = [](const Definition& definition) {
    const auto mechanics = mechanics_of(definition);
    EXPECT_FALSE(runs::fits(mechanics->card(), find_scheme("lifted_splitting").value()));
    return mechanics->card().offers;
  };
  const auto says = [&](const char* h, const char* what) {
    const std::string words = offers(of(hamiltonian, {"x", "y"}, {{"a", 1}}, h));
    EXPECT_NE(words.find(what), words.npos) << h << ": " << words;
    EXPECT_NE(words.find("contact_gauss takes that"), words.npos) << words;
  };
  says("(1 + x^2)*px^2/2 + py^2/2 + y*px", "whose coefficient of px^2 depends on the place");
  says("px^2/2 + py^2/2 + a*s*px*py + y*px", "whose coefficient of px*py depends on s");
  says("px^2/2 + py^2*exp(t)/2 + y*px", "whose coefficient of py^2 depends on the time");
  says("px^2/2 + py^4 + y*px", "that is not quadratic in py");
  const auto kepler = mechanics_of(of(hamiltonian, {"x", "y"}, {}, "(px^2 + py^2)/2 - 1/sqrt(x^2 + y^2)"));
  EXPECT_FALSE(runs::fits(kepler->card(), find_scheme("lifted_splitting").value())) << "leapfrog is the same";
}

// A ring of charges in a field, with more coordinates than any compiled class has, up to the maximum.
TEST(LiftedSplitting, IsOfUpToSixtyFourCoordinates) {
  const auto ring = [](std::size_t n) {
    Definition all = of(hamiltonian, {}, {}, "0");
    for (std::size_t i = 0; i < n; ++i) {
      const std::string number = std::to_string(i);
      all.variables.push_back("x" + number);
      all.formula += " + (px" + number + " - sin(x" + std::to_string((i + 1) % n) + "))^2/2 + x" + number + "^2/2";
    }
    return Scene{"ring", std::move(all), {1, 0.5}};
  };
  const Scene most = ring(64), beyond = ring(65);
  const auto mechanics = mechanics_of(most.definition);
  const auto truth = end_of(request_of(most, mechanics, 0, 1, "taylor"));
  EXPECT_LT(distance(truth, end_of(composed(request_of(most, mechanics, 0.05, 1), "kahan_li_6"))), 1e-7);
  const ProblemCard card = mechanics_of(beyond.definition)->card();
  EXPECT_FALSE(runs::fits(card, find_scheme("lifted_splitting").value()));
  EXPECT_NE(card.offers.find("more coordinates than the 64"), card.offers.npos) << card.offers;
}

// q̇ = X(q) alone, and with s: no kinetic energy, nothing is split.
TEST(LiftedSplitting, FollowsAFlow) {
  const auto flow_card = mechanics_of(texts::flow({"x", "v"}, {}, {{"x", "v"}, {"v", "(1 - x^2)*v - x"}}));
  Request plain = typed_as(runs::defaults("damped_oscillator", "taylor"), flow_card);
  begin_at(plain, std::vector<double>{1, 0.2});
  plain.end = 5;
  runs::only_final(plain);
  const auto truth = end_of(plain);
  const Scene scene{"van_der_pol", van_der_pol(), {1, 0.2, 0.3, 0.2}};
  const auto found = end_of(composed(request_of(scene, mechanics_of(scene.definition), 0.01, 5), "kahan_li_8"));
  EXPECT_NEAR(found[0], truth[0], 1e-12);
  EXPECT_NEAR(found[1], truth[1], 1e-12);
  // One coordinate whose velocity is s; p is the slope dv/dx, up to its pole.
  const Scene lienard{"lienard", of(hamiltonian, {"x"}, {}, "px*s - ((1 - x^2)*s - x)"), {1, 0.3, 0.2}};
  plain.end = 0.15;
  const auto near = end_of(plain);
  const auto slope = end_of(composed(request_of(lienard, mechanics_of(lienard.definition), 0.01, 0.15), "kahan_li_8"));
  EXPECT_NEAR(slope[0], near[0], 1e-12);
  EXPECT_NEAR(slope[2], near[1], 1e-12);
}

}  // namespace
}  // namespace lifted
