#include "core/variations/random_direction.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/problem_traits.hpp"

namespace least::variations {

std::vector<double> random_weights(std::size_t columns) {
  if (columns == 1) return {1};
  std::vector<double> weights;
  std::uint64_t random = 0;
  for (std::size_t d = 0; d < columns; ++d) {
    random = random * 6364136223846793005U + 1442695040888963407U;
    const double size = 0.5 + 0.5 * std::ldexp(static_cast<double>((random << 1U) >> 11U), -53);
    weights.push_back(random >> 63U ? size : -size);
  }
  return weights;
}

Direction sum_of(std::span<const Direction> directions, std::span<const double> weights) {
  Direction sum;
  for (std::size_t d = 0; d < directions.size(); ++d)
    for (const auto& [parameter, by] : directions[d]) sum.push_back({parameter, weights[d] * by});
  return sum;
}

std::vector<double> sum_of(std::span<const double> columns, std::span<const double> weights) {
  std::vector<double> sum(columns.size() / weights.size());
  for (std::size_t i = 0; i < columns.size(); ++i) sum[i % sum.size()] += weights[i / sum.size()] * columns[i];
  return sum;
}

double disagreement_along(const std::vector<std::vector<double>>& columns, std::span<const double> weights,
                          const std::vector<std::vector<double>>& control) {
  const double hidden = weights.size() > 1 ? 3 : 1;
  double most = 0, largest = 0, largest_sum = 0;
  for (std::size_t k = 0; k < columns.size(); ++k) {
    for (const double entry : columns[k]) largest = std::max(largest, std::abs(entry));
    const std::vector<double> sum = sum_of(columns[k], weights);
    for (std::size_t i = 0; i < sum.size(); ++i) {
      if (const double d = std::abs(sum[i] - control[k][i]); !(d <= most)) most = d;  // written so that NaN is kept
      if (std::isnan(most)) return most;
      largest_sum = std::max(largest_sum, std::abs(sum[i]));
    }
  }
  largest = std::min(largest, largest_sum);  // where columns cancel in the sum, their common errors cancel as well
  if (largest > 0) return hidden * most / largest;
  return most > 0 ? unknown : 0;
}

}  // namespace least::variations
