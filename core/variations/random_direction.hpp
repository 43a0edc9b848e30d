// One direction w that stands for all directions of the derivatives, so that one control suffices: J w from the control
// is compared with J w from the columns of J. Errors of the columns add up in J w; as the weights are random, they
// rarely cancel.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/variations/varied_motion.hpp"

namespace least::variations {

/// random_weights returns weights of so many columns, the same at each call: of either sign, between ½ and 1 in size.
/// Columns keep their own scale, as errors are relative to the largest entry of all columns.
std::vector<double> random_weights(std::size_t columns);

/// sum_of returns Σ w_d of directions, or of columns that are stored one after the other.
Direction sum_of(std::span<const Direction> directions, std::span<const double> weights);
std::vector<double> sum_of(std::span<const double> columns, std::span<const double> weights);

/// disagreement_along estimates the largest error of an entry of J divided by the largest entry, from the columns at
/// some times and the control's J w at each. The error of J w is seldom less than a third of the largest error of an
/// entry: over the catalogue, three times it exceeds the true error in nine of ten cases, and mostly by less than a
/// factor five.
double disagreement_along(const std::vector<std::vector<double>>& columns, std::span<const double> weights,
                          const std::vector<std::vector<double>>& control);

}  // namespace least::variations
