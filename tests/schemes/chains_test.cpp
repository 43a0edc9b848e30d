// Chains of 4 and of 8, and a flow of 16 variables: more degrees of freedom than the catalogue has, by every scheme
// that fits.
#include "tests/support/chains.hpp"

namespace {

using namespace chains;

const Names controls{"explicit_euler", "explicit_midpoint", "runge_kutta_4"};
const Names symplectic{"explicit_euler", "explicit_midpoint", "runge_kutta_4",        "ruth_3",
                       "leapfrog",       "galerkin_4",        "variational_midpoint", "symplectic_euler"};
const Names with_tolerance{"dormand_prince_5", "fehlberg_78", "bulirsch_stoer", "taylor"};
const Names clocks{"energy_momentum", "jacobi_maupertuis", "time_transformed", "adaptive_verlet"};

/// The centre of mass of a ring moves freely: all schemes but the hybrid keep the total momentum, which is linear in p.
template <int N>
void ring() {
  const auto momentum = [](const auto& x) {
    double sum = 0;
    for (const double p : x.p) sum += p;
    return sum;
  };
  EXPECT_EQ((fixed_steps_have_their_order<Toda<N>::template Ring>(0.8, momentum)), symplectic);
  EXPECT_EQ((tolerances_are_met<Toda<N>::template Ring>(2)), with_tolerance);
  EXPECT_EQ((clocks_have_their_order<Toda<N>::template Ring>(0.4)), clocks);
}

TEST(Chains, OfFour) { ring<4>(); }
TEST(Chains, OfEight) { ring<8>(); }

TEST(Chains, TheReferenceKeepsWhatTheLatticeKeeps) {
  const Toda<8>::Ring<> lattice;
  const auto from = start<State<8>>(), to = truth(lattice, from, 5);
  const auto before = lattice.invariants(from.q, from.p, 0), after = lattice.invariants(to.q, to.p, 0);
  EXPECT_NEAR(after[0], before[0], 1e-14);
  EXPECT_NEAR(after[1], before[1], 1e-13);
  EXPECT_NEAR(energy(lattice, to), energy(lattice, from), 1e-13);
  EXPECT_GT(laws::distance(from, to), 1);
}

TEST(Chains, AFlowOfSixteen) {
  EXPECT_EQ((fixed_steps_have_their_order<Lorenz96<16>::Flow>(0.1, [](const auto&) { return 0; })), controls);
  EXPECT_EQ((tolerances_are_met<Lorenz96<16>::Flow>(0.5)), with_tolerance);
}

}  // namespace
