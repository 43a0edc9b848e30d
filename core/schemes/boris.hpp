// boris: charges in magnetic fields, in places and velocities. Of H = Σ (p − a(q))²/2m + V(q, t) the velocities turn,
//   m v̇_i = Σ_j (∂_i a_j − ∂_j a_i) v_j − ∂_i V,
// and a step is a sum of explicit ones, each of them exact:
//   drift h/2, kick h/2 by −∇V, turn h about the field there, kick h/2, drift h/2   (order 2, symmetric)
// and what that is composed to. All parts keep the volume of (q, v), which is that of (q, p), and the turn keeps |v|,
// so that without V the kinetic energy is kept to round-off. It is symplectic in no field but special ones: the energy
// of long runs stays near where the step is short against a gyration or the field is uniform, and nothing proves it
// elsewhere. lifted_splitting keeps the symplectic form of the same scenes, with a motion along a that is solved for.
// The turn is by the whole angle h|B|, not by the 2 atan(h|B|/2) of many codes, whose error is of the same order.
// Which scenes it runs is found from their text: core/text/magnetic.hpp. The map: core/schemes/boris_stepper.hpp.
// Sources: Boris, Proc. 4th Conf. Numerical Simulation of Plasmas 3 (1970); Qin et al., Phys. Plasmas 20, 084503
// (2013); He, Sun, Liu, Qin, J. Comput. Phys. 281, 135 (2015); Hairer, Lubich, BIT 58, 969 (2018) on the energy.
#pragma once

#include <tuple>

#include "core/scheme.hpp"

namespace least {

struct Boris {
  double step = 0.01;
  Composition composition = Composition::none;
  static constexpr std::tuple fields{step_field<Boris>(), composition_field<Boris>()};
  static SchemeCard card() {
    return {
        .id = "boris",
        .title = "Boris splitting",
        .summary =
            "Drifts, kicks by the electric and exact turns by the magnetic field: explicit, and the volume of "
            "places and velocities is kept.",
        .orders = orders_from(2),
        .symmetric = true,
        .structure = "volume",
        .recommended = "kahan_li_6",
        .good_for =
            "charges in magnetic fields, frames that turn: the cheapest explicit steps there, which keep the "
            "volume and without a potential the speed; the energy stays near over long runs",
        .fails_when =
            "a step does not resolve the gyration, or the symplectic form has to be kept: lifted_splitting does",
        .needs =
            "a scene as text whose Hamiltonian is Σ (p − a(q))²/2m + V(q, t), with constant masses, where the "
            "field of a turns the velocities of at most three coordinates into one another",
        .references = {"Boris, Proc. 4th Conf. Numerical Simulation of Plasmas 3 (1970)",
                       "Qin, Zhang, Xiao, Liu, Sun, Tang, Phys. Plasmas 20, 084503 (2013)",
                       "He, Sun, Liu, Qin, J. Comput. Phys. 281, 135 (2015)", "Hairer, Lubich, BIT 58, 969 (2018)"}};
  }
};

}  // namespace least
