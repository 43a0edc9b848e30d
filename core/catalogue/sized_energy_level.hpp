// Energies of scenes H = ½ pᵀg⁻¹p + V(q), whose size is known only at run time, that schemes which choose the length of
// their steps conserve.
#pragma once

#include <vector>

#include "core/text/sized_scene.hpp"

namespace least {

/// EnergyLevel is an energy of a run, and its derivatives with respect to the start (q, p).
struct EnergyLevel {
  double value;
  std::vector<double> slopes;
};
/// energy_of_start returns H at the start x = (q, p).
EnergyLevel energy_of_start(const text::SizedScene& scene, const double* x);
/// energy_of_first_step returns the discrete energy of a first step of this length of the variational midpoint rule, or
/// H if that step fails. With a constant metric it leaves out the constant terms of V.
EnergyLevel energy_of_first_step(const text::SizedScene& scene, const double* x, double step);

}  // namespace least
