// adaptive_boris: steps of boris whose length follows the motion by a symmetric controller. With U(q) for how fast the
// motion is there, ρ for the density of steps, and σ,
//   ρ += (σ/2) d(ln U)/dt;  a step of boris, composed or not, of the length σ/ρ;  ρ += (σ/2) d(ln U)/dt
// where the first derivative is that of the state before and the second that of the one after: ρ follows U in units of
// its own, as ρ′ = ρ d(ln U)/dt in the fictitious time of equal σ/ρ. U is the fastest that forces and fields change
// anything,
//   U⁴ = ‖M^{−½} V″ M^{−½}‖² + Ω⁴, Ω the angular velocity of the turn,
// so that steps are as r^{3/2} near a centre and as 1/|B| in a field, whatever the units. The order is that of boris
// with its composition. The volume of (q, v, ρ, t) is kept, and steps go back where they came from; it is not
// symplectic, no more than boris is. Without a potential the speed is kept to round-off. ρ is state: a step depends on
// where the run began. It assumes that ρ stays near U: where it falls to 0 a step is singular. `step` is the length in
// time of a step at the start. Look-alike: a step chosen from the state before each step is not reversible. Sources:
// Hairer & Söderlind, SIAM J. Sci. Comput. 26, 1838 (2005); those of core/schemes/boris.hpp.
#pragma once

#include <tuple>

#include "core/scheme.hpp"

namespace least {

struct AdaptiveBoris {
  double step = 0.01;
  Composition composition = Composition::none;

  static constexpr bool own_clock = true, remembers = true, asks_no_level = true;
  static constexpr std::tuple fields{step_field<AdaptiveBoris>(), composition_field<AdaptiveBoris>()};
  static SchemeCard card() {
    return {.id = "adaptive_boris",
            .title = "Adaptive Boris splitting",
            .summary =
                "Boris' splitting by steps that are short where forces and fields are strong, chosen by a symmetric "
                "controller: reversible, explicit, to any order; not symplectic. `step` is the length in time of a "
                "step at the start of the run.",
            .orders = orders_from(2),
            .symmetric = true,
            .structure = "volume",
            .recommended = "kahan_li_8",
            .good_for =
                "close passages in a frame that turns, as on Arenstorf's orbits; charges that come near to a dipole "
                "and leave it",
            .fails_when =
                "a step does not resolve how fast the pace changes (then it stops as singular), or the symplectic form "
                "has to be kept: lifted_splitting does",
            .needs =
                "a scene as text whose Hamiltonian is Σ (p − a(q))²/2m + V(q), with constant masses, where the field "
                "of a turns the velocities of at most three coordinates into one another and V does not depend on time",
            .references = {"Hairer, Söderlind, SIAM J. Sci. Comput. 26, 1838 (2005)",
                           "He, Sun, Liu, Qin, J. Comput. Phys. 281, 135 (2015)"}};
  }
};

}  // namespace least
