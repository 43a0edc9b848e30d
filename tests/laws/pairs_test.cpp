// Which schemes apply to which scene, listed here by hand: the compiler finds the pairs, and has to find these.
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>

#include "tests/support/runs.hpp"

namespace {

using namespace least;
using Ids = std::set<std::string>;

Ids together(Ids a, const Ids& b) {
  a.insert(b.begin(), b.end());
  return a;
}

const Ids anything{"explicit_euler", "explicit_midpoint", "runge_kutta_4", "dormand_prince_5",
                   "fehlberg_78",    "bulirsch_stoer",    "taylor"};
const Ids lagrangian = together(
    anything, {"variational_midpoint", "galerkin_4", "jacobi_maupertuis", "energy_momentum", "time_transformed"});
const Ids separable = together(lagrangian, {"symplectic_euler", "leapfrog", "ruth_3", "adaptive_verlet"});
const Ids contact = together(anything, {"contact_symplectic_euler", "contact_leapfrog", "contact_variational_midpoint",
                                        "contact_galerkin_4", "contact_splitting", "contact_gauss"});
const Ids damped = together(contact, {"time_transformed"});
const Ids split = together(anything, {"contact_splitting", "lifted_splitting"});

const std::map<std::string, Ids> expected{
    {"harmonic_oscillator", separable},
    {"pendulum", separable},
    {"kepler", separable},
    {"kepler_3d", separable},
    {"henon_heiles", separable},
    {"double_pendulum", lagrangian},
    {"damped_oscillator", damped},
    {"modulated_oscillator", damped},
    {"driven_oscillator", damped},
    {"damped_pendulum", damped},
    {"perturbed_kepler", damped},
    {"damped_kepler", damped},
    {"lane_emden", damped},
    {"spin_orbit", damped},
    {"cosmological_oscillator", contact},
    {"scalar_field_cosmology", contact},
    {"van_der_pol", split},
    {"thermostat", split},
    {"gradient_flow", split},
    {"lorenz", split},
    {"generic_oscillator", split},
};

TEST(Pairs, AreTheseAndNoOthers) {
  for (const auto& [id, schemes_that_fit] : expected) {
    const ProblemCard& problem = runs::problem_card(id);
    Ids found;
    for (const std::size_t scheme : problem.schemes) found.insert(schemes()[scheme].id);
    EXPECT_EQ(found, schemes_that_fit) << id;
  }
  for (const SchemeCard& scheme : schemes()) EXPECT_FALSE(scheme.needs.empty()) << scheme.id;
}

// The schemes of every problem, also of one that is not listed above, are exactly those of one of these kinds.
TEST(Pairs, OfEveryProblemAreThoseOfAKind) {
  const std::set<Ids> kinds{lagrangian, separable, contact, damped, split, anything};
  for (const ProblemCard& problem : runs::problem_cards()) {
    Ids found;
    for (const std::size_t scheme : problem.schemes) found.insert(schemes()[scheme].id);
    EXPECT_TRUE(kinds.contains(found)) << problem.id;
  }
}

}  // namespace
