#include "core/run/tangent_map.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/number/linear.hpp"

namespace least {

namespace {

/// balanced_units returns units of the coordinates, powers of 2, with inverse units for the momenta, in which the
/// couplings between both are similar in size. With masses of 1e-9 entries of order t/m and of order mt stand side by
/// side, and the rounding of the larger ones hides all defects. Source: Osborne, J. ACM 7, 338 (1960), restricted to
/// symplectic scalings.
std::vector<double> balanced_units(const TangentMap& map) {
  constexpr int rounds = 16;
  const std::size_t n = map.dof;
  std::vector<double> unit(n, 1.0);
  for (int round = 0; round < rounds; ++round) {
    bool changed = false;
    for (std::size_t i = 0; i < n; ++i) {
      double with = std::abs(map.slope(i, n + i)) / (unit[i] * unit[i]);  // decreases with the unit
      double against = std::abs(map.slope(n + i, i)) * unit[i] * unit[i];
      for (std::size_t j = 0; j < n; ++j) {
        if (j == i) continue;
        const double far = unit[i] / unit[j], both = unit[i] * unit[j];
        with += std::abs(map.slope(i, j)) / far + std::abs(map.slope(n + j, n + i)) / far +
                std::abs(map.slope(i, n + j)) / both + std::abs(map.slope(j, n + i)) / both;
        against += std::abs(map.slope(j, i)) * far + std::abs(map.slope(n + i, n + j)) * far +
                   std::abs(map.slope(n + i, j)) * both + std::abs(map.slope(n + j, i)) * both;
      }
      // The 1 stands for the diagonal, which is the same in all units.
      const double by = std::exp2(std::round(std::log2((1 + with) / (1 + against)) / 4));
      if (by == 1 || !std::isfinite(by)) continue;
      unit[i] *= by;
      changed = true;
    }
    if (!changed) break;
  }
  return unit;
}

}  // namespace

double symplectic_defect(const TangentMap& map) {
  const std::size_t n = map.dof;
  const std::vector<double> units = balanced_units(map);
  const auto unit = [&](std::size_t a) { return a < n ? units[a] : 1 / units[a - n]; };
  double most = 0;
  for (std::size_t a = 0; a < 2 * n; ++a)
    for (std::size_t b = 0; b < 2 * n; ++b) {
      double sum = a + n == b ? -1 : (b + n == a ? 1 : 0);
      for (std::size_t i = 0; i < n; ++i)
        sum += map.slope(i, a) * map.slope(n + i, b) - map.slope(n + i, a) * map.slope(i, b);
      sum *= unit(a) * unit(b);
      most = std::isnan(sum) ? sum : std::max(most, std::abs(sum));
    }
  return most;
}

ContactDefect contact_defect(const TangentMap& map) {
  const std::size_t n = map.dof, s = 2 * n;
  const auto pulled = [&](std::size_t j) {  // φ*η along direction j
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
