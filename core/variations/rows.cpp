#include "core/variations/rows.hpp"

#include <algorithm>
#include <cmath>

#include "core/run/tangent_map.hpp"

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

std::vector<Report> structure_of(const ParametricScene& equations, const std::vector<double>& start,
                                 const std::vector<double>& end, const Slopes& rows) {
  const std::size_t size = equations.components, n = equations.coordinates;
  TangentMap map{n, {0, StateNumbers(start.data(), start.data() + size)}, {}, {}, false};
  map.to = {0, StateNumbers(end.data(), end.data() + size)};
  // Signs undone: derivatives of components by components, not by the card's variables
  for (std::size_t i = 0; i < size; ++i)
    for (std::size_t j = 0; j < size; ++j)
      map.m.push_back(equations.signs[i] * equations.signs[j] * rows[i * size + j]);
  if (n == 0 || equations.forced) return {words("kind", "none"), {"max_defect", unknown}, {"factor", determinant(map)}};
  if (equations.acting) {
    const ContactDefect found = contact_defect(map);
    return {words("kind", "contact"), {"max_defect", found.defect}, {"factor", found.factor}};
  }
  double factor = 1;
  const bool damped = !equations.action_slope.is_constant() || equations.action_slope.constant() != 0;
  // The flow of (q, p) multiplies the symplectic form by the same factor as that of (q, p, s) the contact form
  if (damped) {
    factor = 0;
    for (std::size_t i = 0; i < n; ++i)
      factor += map.slope(i, 0) * map.slope(n + i, n) - map.slope(n + i, 0) * map.slope(i, n);
    for (double& slope : map.m) slope /= std::sqrt(factor);
  }
  return {words("kind", damped ? "contact" : "symplectic"),
          {"max_defect", factor * symplectic_defect(map)},
          {"factor", factor}};
}

}  // namespace least::variations
