// Kinetic matrices that are constant but not diagonal: such scenes are separable, like those with diagonal ones.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/text/scene.hpp"
#include "tests/support/texts.hpp"

namespace {

using namespace texts;
using text::FormKind;

constexpr auto typed_l = Definition::Kind::lagrangian, typed_h = Definition::Kind::hamiltonian;

const text::Form& form_in(const Definition& definition) { return *mechanics_of(definition)->text()->form; }

// g⁻¹ = ((2, −1), (−1, 2)) and V = (x² + y²)/2: x + y oscillates with the frequency 1, x − y with √3.
Definition coupled(const std::string& more = "") {
  return of(typed_h, {"x", "y"}, {{"m", 1}}, "px^2 + py^2 - px*py/m + (x^2 + y^2)/2" + more);
}
// The same by its Lagrangian, g = ((2, 1), (1, 2))/3.
Definition coupled_by_velocities(const std::string& more = "") {
  return of(typed_l, {"x", "y"}, {{"m", 1}}, "(vx^2 + vy^2 + m*vx*vy)/3 - (x^2 + y^2)/2" + more);
}
// Four coordinates in a chain, with a tridiagonal metric.
Definition chain() {
  return of(typed_l, {"a", "b", "c", "d"}, {},
            "va^2 + vb^2 + vc^2 + vd^2 + (va*vb + vb*vc + vc*vd)/2 - (a^2 + b^2 + c^2 + 2*d^2)/2 - a*b*d/5 - d^4/9");
}

Request request_of(const Definition& definition, std::string_view scheme, const std::vector<double>& start,
                   double end) {
  return request_by(scheme, mechanics_of(definition), start, end);
}

/// truth() returns x, y, px, py of the coupled oscillators from (1, 0.3; 0.2, −0.5), each mode damped by α: q̈ + αq̇ +
/// ω²q = 0.
std::array<double, 4> truth(double t, double alpha) {
  const auto mode = [=](double u, double rate, double omega) {
    const double k = std::sqrt(omega * omega - alpha * alpha / 4), c = (rate + alpha / 2 * u) / k,
                 decay = std::exp(-alpha * t / 2), value = decay * (u * std::cos(k * t) + c * std::sin(k * t));
    return std::array{value, -alpha / 2 * value + decay * k * (c * std::cos(k * t) - u * std::sin(k * t))};
  };
  // p = g q̇: the momentum of the sum is q̇₊, that of the difference q̇₋/3.
  const auto [plus, plus_rate] = mode(1.3, -0.3, 1);
  const auto [minus, minus_rate] = mode(0.7, 3 * 0.7, std::sqrt(3));
  return {(plus + minus) / 2, (plus - minus) / 2, (plus_rate + minus_rate / 3) / 2, (plus_rate - minus_rate / 3) / 2};
}
const std::vector<double> coupled_start{1, 0.3, 0.2, -0.5};

double error(Request request, double step, double alpha) {
  runs::set(request, "step", step);
  const auto x = final_of(request);
  double most = 0;
  for (std::size_t i = 0; i < 4; ++i) most = std::max(most, std::abs(x[i] - truth(request.end, alpha)[i]));
  return most;
}

struct Choice {
  const char *scheme, *setting, *value;
  int order;
};

TEST(FullMass, IsOfTheFormOfADiagonalOne) {
  for (const auto& definition : {coupled(), coupled_by_velocities(), chain()}) {
    EXPECT_EQ(form_in(definition).kind, FormKind::separable);
    EXPECT_TRUE(form_in(definition).full_mass && form_in(definition).keeps_energy);
  }
  EXPECT_EQ(form_in(coupled("*(1 + cos(t)/3)")).kind, FormKind::separable) << "V(q, t) was a general Hamiltonian's";
  EXPECT_EQ(form_in(coupled(" + 0.2*s")).kind, FormKind::contact_linear);
  EXPECT_EQ(form_in(coupled_by_velocities(" - 0.2*s/(1 + t)")).kind, FormKind::contact_linear);
  EXPECT_EQ(form_in(coupled(" + s^2/8")).kind, FormKind::contact_quadratic);
  EXPECT_EQ(form_in(coupled(" + x*px*py/9")).kind, FormKind::metric) << "depends on the place";
  EXPECT_EQ(form_in(coupled(" + x*py")).kind, FormKind::hamiltonian) << "linear in the momenta";
  EXPECT_EQ(form_in(of(typed_h, {"x", "y"}, {}, "px*py + x^2")).kind, FormKind::hamiltonian) << "of both signs";
  EXPECT_FALSE(form_in(of(typed_h, {"x", "y"}, {{"m", 3}}, "px^2/m + py^2 + x^2")).full_mass);
  const auto schemes_of = [](const Definition& definition) { return mechanics_of(definition)->card().schemes; };
  EXPECT_EQ(schemes_of(coupled()), schemes_of(of(typed_h, {"x", "y"}, {}, "px^2 + py^2 + x^2")));
  EXPECT_EQ(schemes_of(coupled(" + s/5")), schemes_of(of(typed_h, {"x", "y"}, {}, "px^2 + py^2 + x^2 + s/5")));
}

// Parameters decide whether it is positive definite: m = 1/2 gives g⁻¹ = ((2, −2), (−2, 2)), which is singular; m = 1/3
// is worse.
TEST(FullMass, IsPositiveDefinite) {
  for (const auto& [m, good] : {std::pair(1.0, true), std::pair(0.51, true), std::pair(0.5, false),
                                std::pair(0.33, false), std::pair(0.0, false), std::pair(-1.0, true)}) {
    const auto objection = mechanics_of(coupled())->text()->objection(std::vector{m});
    EXPECT_EQ(!objection, good) << m;
    if (objection) {
      EXPECT_NE(objection->detail.find("positive"), std::string::npos) << objection->detail;
    }
  }
}

TEST(FullMass, SchemesHaveTheirOrders) {
  const Choice rows[] = {{"symplectic_euler", "", "", 1},
                         {"leapfrog", "composition", "none", 2},
                         {"leapfrog", "composition", "suzuki_4", 4},
                         {"leapfrog", "composition", "kahan_li_6", 6},
                         {"ruth_3", "", "", 3},
                         {"adaptive_verlet", "", "", 2},
                         {"variational_midpoint", "composition", "none", 2},
                         {"galerkin_4", "composition", "none", 4},
                         {"energy_momentum", "", "", 2},
                         {"jacobi_maupertuis", "", "", 4},
                         {"runge_kutta_4", "", "", 4}};
  for (const auto& definition : {coupled(), coupled_by_velocities()})
    for (const auto& [scheme, setting, value, order] : rows) {
      Request request = request_of(definition, scheme, coupled_start, 4);
      if (*setting != '\0') runs::set(request, setting, value);
      const double h = order >= 6 ? 0.4 : 0.05, measured = std::log2(error(request, h, 0) / error(request, h / 2, 0));
      EXPECT_NEAR(measured, order, 0.3) << scheme << " " << value;
    }
}

// The setting of time_transformed is a step in a fictitious time.
TEST(FullMass, TimeTransformedHasItsOrders) {
  for (const auto& definition : {coupled(), coupled_by_velocities()})
    for (const auto& [composition, order] : {std::pair("none", 2), std::pair("suzuki_4", 4)}) {
      const auto at = [&, composition = composition](double sigma) {
        Request request = request_of(definition, "time_transformed", coupled_start, 4);
        runs::set(request, "composition", composition);
        runs::set(request, "sigma", sigma);
        const auto x = final_of(request);
        double most = 0;
        for (std::size_t i = 0; i < 4; ++i) most = std::max(most, std::abs(x[i] - truth(4, 0)[i]));
        return most;
      };
      EXPECT_NEAR(std::log2(at(0.1) / at(0.05)), order, 0.3) << composition;
    }
}

TEST(FullMass, SchemesOfDampedScenesHaveTheirOrders) {
  const Choice rows[] = {{"contact_symplectic_euler", "", "", 1},
                         {"contact_leapfrog", "composition", "none", 2},
                         {"contact_leapfrog", "composition", "suzuki_4", 4},
                         {"contact_splitting", "splitting", "plain", 2},
                         {"contact_splitting", "splitting", "merged", 2},
                         {"contact_splitting", "splitting", "saba_2", 2},
                         {"contact_splitting", "splitting", "saba_4", 2},
                         {"contact_splitting", "splitting", "aba_864", 4},
                         {"contact_splitting", "splitting", "aba_1064", 4},
                         {"contact_variational_midpoint", "composition", "none", 2},
                         {"contact_galerkin_4", "", "", 4},
                         {"contact_gauss", "", "", 4}};
  constexpr double alpha = 0.2;
  for (const auto& definition : {coupled(" + s/5"), coupled_by_velocities(" - s/5")})
    for (const auto& [scheme, setting, value, order] : rows) {
      Request request = request_of(definition, scheme, coupled_start, 4);
      if (*setting != '\0') runs::set(request, setting, value);
      const double measured = std::log2(error(request, 0.1, alpha) / error(request, 0.05, alpha));
      EXPECT_NEAR(measured, order, 0.3) << scheme << " " << value;
    }
}

// The map of each step, by dual numbers, keeps dp∧dq, or η up to its factor.
TEST(FullMass, TheFormIsKept) {
  const std::vector<double> four{0.5, -0.3, 0.2, 0.4, 0.1, 0.3, -0.2, 0.5};
  const struct {
    Definition definition;
    const char* scheme;
    std::vector<double> from;
  } rows[] = {{coupled(" + x^2*y/5"), "symplectic_euler", coupled_start},
              {coupled(" + x^2*y/5"), "leapfrog", coupled_start},
              {coupled(" + x^2*y/5"), "ruth_3", coupled_start},
              {chain(), "leapfrog", four},
              {chain(), "galerkin_4", four},
              {coupled(" + x^2*y/5 + s/5"), "contact_leapfrog", coupled_start},
              {coupled(" + x^2*y/5 + s/5"), "contact_splitting", coupled_start}};
  for (const auto& [definition, scheme, from] : rows) {
    Request request = request_of(definition, scheme, from, 3);
    runs::set(request, "step", 0.1);
    runs::ask(request, "structure");
    const auto found = runs::go(request).outcome.diagnostics;
    EXPECT_LT(runs::number(found, "structure/max_defect"), 1e-13) << scheme;
  }
}

TEST(FullMass, LeapfrogComesBackAndItsEnergyStays) {
  const std::vector<double> from{0.5, -0.3, 0.2, 0.4, 0.1, 0.3, -0.2, 0.5};
  Request there = request_of(chain(), "leapfrog", from, 20);
  runs::set(there, "step", 0.125);
  runs::ask(there, "energy");
  std::vector<double> x = final_of(there);
  for (std::size_t i = 4; i < 8; ++i) x[i] = -x[i];
  Request back = request_of(chain(), "leapfrog", x, 20);
  runs::set(back, "step", 0.125);
  const auto again = final_of(back);
  for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(again[i], i < 4 ? from[i] : -from[i], 1e-13);
  // The energy is that of the text: ½ pᵀg⁻¹p with g from the Lagrangian, at the start by hand, with a solution of g v =
  // p.
  Request fine = request_of(chain(), "taylor", from, 20);
  runs::ask(fine, "energy");
  const auto said = runs::go(fine).outcome.diagnostics, rough = runs::go(there).outcome.diagnostics;
  EXPECT_LT(runs::number(said, "energy/max_abs_error"), 1e-12);
  EXPECT_NEAR(runs::number(said, "energy/initial"), runs::number(rough, "energy/initial"), 1e-15);
  EXPECT_GT(runs::number(rough, "energy/max_abs_error"), 1e-6);
  EXPECT_LT(runs::number(rough, "energy/max_abs_error"), 1e-2);
}

// Energies of the coupled oscillators by hand: px² + py² − px py + (x² + y²)/2 = .04 + .25 + .1 + .545.
TEST(FullMass, TheEnergyIsThatOfTheText) {
  for (const auto& definition : {coupled(), coupled_by_velocities()}) {
    Request request = request_of(definition, "leapfrog", coupled_start, 1);
    runs::ask(request, "energy");
    EXPECT_NEAR(runs::number(runs::go(request).outcome.diagnostics, "energy/initial"), 0.935, 1e-15);
  }
}

TEST(FullMass, VelocitiesBecomeMomenta) {
  const auto mechanics = mechanics_of(coupled_by_velocities());
  std::vector<double> state{1, 0.3, 0.9, -1.2};
  mechanics->text()->velocities_to_momenta(std::vector{1.0}, 0, state);
  EXPECT_NEAR(state[2], 0.2, 1e-15);
  EXPECT_NEAR(state[3], -0.5, 1e-15);
}

// The printed equations, evaluated again as a flow, are the motion.
TEST(FullMass, EquationsAsTextAreThoseOfTheMotion) {
  for (const auto& definition :
       {coupled(), coupled_by_velocities(), coupled(" + s/5"), coupled_by_velocities(" - s/5")}) {
    const auto mechanics = mechanics_of(definition);
    auto equations = mechanics->text()->equations();
    ASSERT_GE(equations.size(), 4U);
    equations.resize(4);  // that of s, which the others do not need, is tested below
    std::vector<std::string> names;
    for (const auto& [name, rate] : equations) names.push_back(name);
    EXPECT_EQ(names, (std::vector<std::string>{"x", "y", "px", "py"}));
    const auto printed = final_of(request_of(flow(names, {{"m", 1}}, equations), "taylor", coupled_start, 3)),
               own = final_of(request_of(definition, "taylor", coupled_start, 3));
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(printed[i], own[i], 1e-11) << definition.formula;
  }
  const auto of_action = mechanics_of(coupled(" + s^2/8"))->text()->equations();
  EXPECT_EQ(of_action[3].second, "-y - 0.25*s*py");
  EXPECT_EQ(of_action[4].first, "s");
  // For four coordinates the equations have the inverse metric if it consists of numbers.
  EXPECT_EQ(mechanics_of(chain())->text()->equations()[4].first, "pa");
  EXPECT_TRUE(mechanics_of(chain())->text()->note_on_equations(mechanics_of(chain())->text()->equations()).empty());
  Definition of_parameters = chain();
  of_parameters.parameters = {{"k", 0.5}};
  of_parameters.formula += " + k*va*vc/4";
  const auto with_parameters = mechanics_of(of_parameters);
  EXPECT_EQ(with_parameters->text()->equations()[0].first, "pa") << "with velocities, as of a metric";
  EXPECT_FALSE(with_parameters->text()->note_on_equations(with_parameters->text()->equations()).empty());
}

// Masses that couple all coordinates of a chain have a full inverse: for 300 coordinates it is short enough for a run,
// but not to be printed; for more than about 330 it is neither.
TEST(FullMass, AnInverseTooLongToBeSaidIsNot) {
  const auto made = [](double n) {
    text::TypedScene typed;
    typed.scene = of(typed_l, {"x[n]"}, {{"n", n}},
                     "sum(i=1..n, vx[i]^2/2) + 0.3*sum(i=1..n-1, vx[i]*vx[i+1]) - sum(i=1..n, x[i]^2/2)");
    return custom_mechanics(std::move(typed));
  };
  const auto mechanics = std::get<std::shared_ptr<const Mechanics>>(made(300));
  const auto equations = mechanics->text()->equations();
  ASSERT_EQ(equations.size(), 600U);
  for (const auto& [name, rate] : equations) EXPECT_EQ(rate, "…") << name;
  EXPECT_NE(mechanics->text()->note_on_equations(equations).find("too many operations"), std::string::npos);
  const auto refused = made(400);
  const auto* const faults = std::get_if<std::vector<text::DefinitionFault>>(&refused);
  ASSERT_NE(faults, nullptr);
  EXPECT_EQ(faults->front().pointer, "/lagrangian");
  EXPECT_NE(faults->front().fault.detail.find("couple too many coordinates"), std::string::npos);
}

}  // namespace
