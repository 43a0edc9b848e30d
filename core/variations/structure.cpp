#include "core/variations/structure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/number/linear.hpp"
#include "core/variations/doubt.hpp"

namespace least::variations {
namespace {

/// Factor is a factor as the map shows it, and its condition number: how much larger than the relative rounding of the
/// entries of the map its relative error may be.
struct Factor {
  double value = unknown, condition = unknown;

  bool is_clear() const {
    constexpr double most = 4096;  // leaves some 12 digits
    return condition <= most;
  }
};

bool keeps_no_form(const ParametricScene& equations) { return equations.coordinates == 0 || equations.forced; }

/// is_volume tells whether the factor is that of volumes, as that of the area is for one coordinate.
bool is_volume(const ParametricScene& equations) {
  return keeps_no_form(equations) || (equations.coordinates == 1 && !equations.acting);
}

/// volume_of returns det M, whose relative change is Σ (M⁻¹)ⱼᵢ dMᵢⱼ.
Factor volume_of(const TangentMap& map) {
  const std::size_t size = map.size();
  std::vector<double> inverse = map.m;
  detail::invert(size, inverse.data());
  Factor volume{determinant(map), 0};
  for (std::size_t i = 0; i < size; ++i)
    for (std::size_t j = 0; j < size; ++j) volume.condition += std::abs(map.slope(i, j) * inverse[j * size + i]);
  return volume;
}

/// factor_of returns the factor of volumes where no form is kept, else that of the contact form. The flow of (q, p)
/// multiplies the symplectic form by the same factor.
Factor factor_of(const ParametricScene& equations, const TangentMap& map) {
  if (keeps_no_form(equations)) return volume_of(map);
  const std::size_t n = equations.coordinates, s = 2 * n;
  double sum = 0, terms = 0;
  const auto add = [&](double term) {
    sum += term;
    terms += std::abs(term);
  };
  if (equations.acting) add(map.slope(s, s));
  for (std::size_t i = 0; i < n; ++i) {
    if (equations.acting) {
      add(-map.to[n + i] * map.slope(i, s));
    } else {
      add(map.slope(i, 0) * map.slope(n + i, n));
      add(-map.slope(n + i, 0) * map.slope(i, n));
    }
  }
  return {sum, terms / std::abs(sum)};
}

/// Halving determines the factor of a run from those of its parts.
class Halving {
 public:
  Halving(const ParametricScene& equations, const Parts& parts) : equations_(equations), parts_(parts) {}

  /// over returns the factor of the part that begins with the state x, and makes x the state at its end. It ends early
  /// with 0, or with NaN where a part has no map.
  double over(double from, double to, std::vector<double>& x, int depth = 0) const {
    const auto map = parts_.of(from, to, x);
    if (!map) return unknown;
    const Factor direct = factor_of(equations_, *map);
    if (!direct.is_clear() && can_halve(from, to, depth)) return halved(from, to, x, depth);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = map->to[i];
    return direct.is_clear() ? direct.value : limit_of(direct);
  }
  double halved(double from, double to, std::vector<double>& x, int depth) const {
    const double half = std::midpoint(from, to), middle = parts_.by_steps ? std::floor(half) : half;
    const double first = over(from, middle, x, depth + 1);
    return first == 0 || std::isnan(first) ? first : first * over(middle, to, x, depth + 1);
  }
  bool can_halve(double from, double to, int depth) const {
    constexpr int most = 24;
    return depth < most && (!parts_.by_steps || to - from > 1);
  }

 private:
  /// A factor that rounding hides in the shortest part is zero: the map of an event that sets a variable to a number is
  /// singular.
  static double limit_of(const Factor& direct) {
    constexpr double rounding = 64 * std::numeric_limits<double>::epsilon();
    return direct.condition * rounding < 1 || !std::isfinite(direct.value) ? direct.value : 0;
  }

  const ParametricScene& equations_;
  const Parts& parts_;
};

double factor_of_run(const ParametricScene& equations, const TangentMap& map, const Parts& parts) {
  std::vector<double> x;
  for (std::size_t i = 0; i < map.size(); ++i) x.push_back(map.from[i]);
  const Halving halving(equations, parts);
  if (is_volume(equations) && parts.at_end != 1)
    return parts.at_end == 0 ? 0 : parts.at_end * halving.over(parts.from, parts.to, x);
  const Factor direct = factor_of(equations, map);
  if (direct.is_clear() || !halving.can_halve(parts.from, parts.to, 0)) return direct.value;
  return halving.halved(parts.from, parts.to, x, 0);
}

}  // namespace

TangentMap tangent_map(const ParametricScene& equations, const std::vector<double>& start,
                       const std::vector<double>& end, const std::vector<double>& by_direction) {
  const std::size_t size = equations.components;
  TangentMap map{equations.coordinates, {0, StateNumbers(start.data(), start.data() + size)}, {}, {}, false};
  map.to = {0, StateNumbers(end.data(), end.data() + size)};
  map.m.resize(size * size);
  for (std::size_t i = 0; i < size; ++i)
    for (std::size_t j = 0; j < size; ++j) map.m[i * size + j] = equations.signs[j] * by_direction[j * size + i];
  return map;
}

void add_structure(const ParametricScene& equations, const TangentMap& map, const Parts& parts, Sensitivities& found) {
  const bool formless = keeps_no_form(equations), acting = equations.acting;
  const bool damped = acting || !equations.action_slope.is_constant() || equations.action_slope.constant() != 0;
  const double factor = formless || damped ? factor_of_run(equations, map, parts) : 1;
  double defect = unknown;
  if (acting) {
    defect = contact_defect(map).defect;
  } else if (!formless) {
    constexpr double smallest = 1e-200;  // so that squares of derivatives divided by it stay finite
    const double scale = std::max(std::abs(factor), smallest);
    TangentMap scaled = map;
    for (double& slope : scaled.m) slope /= std::sqrt(scale);
    defect = scale * symplectic_defect(scaled);
  }
  found.structure = {words("kind", formless ? "none"
                                   : damped ? "contact"
                                            : "symplectic"),
                     {"max_defect", defect},
                     {"factor", factor}};
  if (std::isnan(factor)) add_reason("the factor of the map is not known: not all parts of the run have a map", found);
}

}  // namespace least::variations
