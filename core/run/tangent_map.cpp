#include "core/run/tangent_map.hpp"

#include <algorithm>
#include <cmath>

#include "core/number/linear.hpp"

namespace least {

double symplectic_defect(const TangentMap& map) {
  const std::size_t n = map.dof;
  double most = 0;
  for (std::size_t a = 0; a < 2 * n; ++a)
    for (std::size_t b = 0; b < 2 * n; ++b) {
      double sum = a + n == b ? -1 : (b + n == a ? 1 : 0);
      for (std::size_t i = 0; i < n; ++i)
        sum += map.slope(i, a) * map.slope(n + i, b) - map.slope(n + i, a) * map.slope(i, b);
      most = std::isnan(sum) ? sum : std::max(most, std::abs(sum));
    }
  return most;
}

ContactDefect contact_defect(const TangentMap& map) {
  const std::size_t n = map.dof, s = 2 * n;
  const auto pulled = [&](std::size_t j) {  // φ*η along the j-th direction
    double sum = map.slope(s, j);
    for (std::size_t i = 0; i < n; ++i) sum -= map.to[n + i] * map.slope(i, j);
    return sum;
  };
  const double factor = pulled(s);
  double most = 0;
  for (std::size_t j = 0; j < s; ++j) {
    const double wrong = pulled(j) + (j < n ? factor * map.from[n + j] : 0.0);
    most = std::isnan(wrong) ? wrong : std::max(most, std::abs(wrong));
  }
  return {most, factor};
}

double determinant(const TangentMap& map) {
  auto rows = map.m;
  return detail::determinant_by_lu(map.size(), rows.data());
}

}  // namespace least
