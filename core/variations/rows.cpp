#include "core/variations/rows.hpp"

#include <algorithm>
#include <cmath>

namespace least::variations {

Slopes in_rows(const ParametricScene& equations, const std::vector<double>& by_direction) {
  const std::size_t size = equations.components, count = by_direction.size() / size;
  Slopes rows(by_direction.size());
  for (std::size_t i = 0; i < size; ++i)
    for (std::size_t d = 0; d < count; ++d) rows[i * count + d] = equations.signs[i] * by_direction[d * size + i];
  return rows;
}

double disagreement(const std::vector<Slopes>& a, const std::vector<Slopes>& b) {
  double most = 0, largest = 0;
  for (std::size_t k = 0; k < a.size(); ++k)
    for (std::size_t i = 0; i < a[k].size(); ++i) {
      if (const double d = std::abs(a[k][i] - b[k][i]); !(d <= most)) most = d;  // written so that NaN is kept
      largest = std::max(largest, std::abs(a[k][i]));
    }
  if (largest > 0) return most / largest;
  return most == 0 ? 0 : unknown;
}

}  // namespace least::variations
