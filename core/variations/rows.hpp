// Derivatives in the layout of the answer.
#pragma once

#include <string>
#include <vector>

#include "core/variations/sensitivities.hpp"

namespace least::variations {

/// bytes_of_lists returns the memory of `times` lists of so many doubles.
constexpr std::size_t bytes_of_lists(std::size_t times, std::size_t numbers) {
  // The list itself, its entry in the answer, spare capacity, and the header of its block
  constexpr std::size_t list = sizeof(std::vector<double>) + 48;
  return times * (numbers * sizeof(double) + list);
}

/// in_rows turns derivatives stored direction by direction into Slopes: component by component, with the sign of the
/// card's variables.
Slopes in_rows(const ParametricScene& equations, const std::vector<double>& by_direction);

/// disagreement returns the largest difference of entries divided by the largest entry of a.
double disagreement(const std::vector<Slopes>& a, const std::vector<Slopes>& b);

}  // namespace least::variations
