// One direction w in the place of all that derivatives are in, for a control: J w as it has it is held against J w from
// the columns of J. Errors of these add up there but for what cancels, by weights that are random.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/variations/varied_motion.hpp"

namespace least::variations {

/// The weights of so many columns, the same each time: from ½ to 1, of either sign. They are no units: columns count as
/// they do in what errors are relative to, the largest entry of all.
std::vector<double> random_weights(std::size_t columns);

/// Σ w_d of directions, and of columns that stand one after the other.
Direction sum_of(std::span<const Direction> directions, std::span<const double> weights);
std::vector<double> sum_of(std::span<const double> columns, std::span<const double> weights);

/// About the largest error of an entry of J, divided by the largest entry, from the columns at some times and J w as a
/// control has it at each. An error in J w is seldom less than a third of the largest of its entries: over the
/// catalogue three times as much is above the true error in nine of ten cases, and mostly within five times of it.
double disagreement_along(const std::vector<std::vector<double>>& columns, std::span<const double> weights,
                          const std::vector<std::vector<double>>& control);

}  // namespace least::variations
