// Energies that schemes which choose the length of their steps hold to, of scenes H = ½ pᵀg⁻¹p + V(q) whose size is
// known when they run.
#pragma once

#include <vector>

#include "core/text/sized_scene.hpp"

namespace least {

/// An energy of a run, and its derivatives by the state (q, p) that the run begins at.
struct EnergyLevel {
  double value;
  std::vector<double> slopes;
};
/// H at the start.
EnergyLevel energy_of_start(const text::SizedScene& scene, const double* x);
/// The discrete energy of a first step of this length of the variational midpoint rule; without one H. Both without the
/// numbers among the terms of V.
EnergyLevel energy_of_first_step(const text::SizedScene& scene, const double* x, double step);

}  // namespace least
