// Derivatives as an answer has them.
#pragma once

#include <string>
#include <vector>

#include "core/run/run_state.hpp"
#include "core/variations/sensitivities.hpp"

namespace least::variations {

/// Component by component, of the variables as they are called, from derivatives direction by direction.
Slopes in_rows(const ParametricScene& equations, const std::vector<double>& by_direction);

/// What the whole map keeps: of the symplectic form, or of the contact form where s is a component, a multiple. `rows`:
/// its derivatives by all components.
std::vector<Report> structure_of(const ParametricScene& equations, const std::vector<double>& start,
                                 const std::vector<double>& end, const Slopes& rows);

/// The largest difference, divided by the largest of a.
double disagreement(const std::vector<Slopes>& a, const std::vector<Slopes>& b);

}  // namespace least::variations
