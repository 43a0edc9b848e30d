// Contact chains of 8, linear and quadratic in s: the largest Newton systems that there are, 30 equations.
#include "tests/support/chains.hpp"
#include "tests/support/tangents.hpp"

namespace {

using namespace chains;

const Names those_that_fit{
    "explicit_euler",    "explicit_midpoint", "runge_kutta_4",    "contact_variational_midpoint", "contact_galerkin_4",
    "contact_splitting", "contact_gauss",     "contact_leapfrog", "contact_symplectic_euler"};
const Names with_tolerance{"dormand_prince_5", "fehlberg_78", "bulirsch_stoer", "taylor"};
const auto nothing = [](const auto&) { return 0; };

TEST(ContactChains, LinearInS) {
  EXPECT_EQ((fixed_steps_have_their_order<Toda<8>::Damped>(0.8, nothing)), those_that_fit);
  EXPECT_EQ((tolerances_are_met<Toda<8>::Damped>(2)), with_tolerance);
}
TEST(ContactChains, QuadraticInS) {
  EXPECT_EQ((fixed_steps_have_their_order<Toda<8>::Quadratic>(0.8, nothing)), those_that_fit);
  EXPECT_EQ((tolerances_are_met<Toda<8>::Quadratic>(2)), with_tolerance);
}

/// The total momentum decays as e^(−αt); a contact scheme has its own factor λ in every step.
TEST(ContactChains, MomentumAndVolumeDecayTogether) {
  const Toda<8>::Damped<> problem;
  const auto from = start<FullStateOf<Toda<8>::Damped<>>>();
  const double h = 0.05;
  const auto tangent = tangent_map(ContactLeapfrog{}, problem, from, h);
  ASSERT_TRUE(tangent);
  const auto [defect, factor] = contact_defect(from, *tangent);
  EXPECT_LT(defect, 1e-13);
  EXPECT_NEAR(factor, std::exp(-problem.alpha * h), 1e-5);
  EXPECT_NEAR(determinant(tangent->m), std::pow(factor, 9), 1e-13);
  double before = 0, after = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    before += from.p[i];
    after += tangent->image.p[i];
  }
  EXPECT_NEAR(after, factor * before, 1e-14);
}

}  // namespace
