// Derivatives as an answer has them.
#pragma once

#include <string>
#include <vector>

#include "core/run/run_state.hpp"
#include "core/variations/sensitivities.hpp"

namespace least::variations {

/// What derivatives at so many times hold, each of them a list of so many numbers.
constexpr std::size_t bytes_of_lists(std::size_t times, std::size_t numbers) {
  constexpr std::size_t list = sizeof(std::vector<double>) + 48;  // itself, its time, more as all grow, and its block
  return times * (numbers * sizeof(double) + list);
}

/// Component by component, of the variables as they are called, from derivatives direction by direction.
Slopes in_rows(const ParametricScene& equations, const std::vector<double>& by_direction);

/// What the whole map keeps: of the symplectic form, or of the contact form where s is a component, a multiple. `rows`:
/// its derivatives by all components.
std::vector<Report> structure_of(const ParametricScene& equations, const std::vector<double>& start,
                                 const std::vector<double>& end, const Slopes& rows);

/// The largest difference, divided by the largest of a.
double disagreement(const std::vector<Slopes>& a, const std::vector<Slopes>& b);

}  // namespace least::variations
