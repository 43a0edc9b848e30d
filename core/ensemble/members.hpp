// The members of an ensemble: scenes that differ in the values of a few quantities, which depend only on the seed and
// the member's index.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/run/request.hpp"

namespace least {

/// Spread is how a quantity varies. Grids and values form their Cartesian product, the last quantity varying fastest;
/// members beyond the product repeat it. The other kinds are random.
enum class Spread : std::uint8_t { grid, values, uniform, normal, logistic };
inline constexpr std::array<std::string_view, 5> spread_names{"grid", "values", "uniform", "normal", "logistic"};

/// Varied is what varies: a variable of the start, the velocity of a coordinate, or a parameter of the problem.
enum class Varied : std::uint8_t { variable, velocity, parameter };

/// Variation is one varied quantity and how it varies.
struct Variation {
  Varied of = Varied::variable;
  std::size_t index = 0;  ///< on the card; for a velocity, of its coordinate
  Spread spread = Spread::grid;
  /// grid: first, last, how many; values: the list; uniform: from, to; normal: mean, standard deviation; logistic:
  /// mean, scale.
  std::vector<double> numbers;

  bool is_parameter() const { return of == Varied::parameter; }
  bool drawn() const { return spread > Spread::values; }
  /// size() returns how many values a variation has that is not random.
  std::int64_t size() const;
};

/// normal_quantile returns the inverse of the normal distribution function for 0 < p < 1, to a relative error of 1e-15
/// and with the same bits on every machine. Source: Wichura, Algorithm AS 241, Appl. Statist. 37, 477 (1988).
double normal_quantile(double p);
/// logistic_quantile returns ln(p/(1 − p)), the same of the logistic distribution.
double logistic_quantile(double p);

/// Members describes all members of an ensemble.
struct Members {
  std::int64_t count = 0;
  std::uint64_t seed = 0;
  std::vector<Variation> vary;
  /// Members share the velocities of the start, not the momenta, where momenta depend on what varies.
  bool holds_velocities = false;
  /// the start's velocities of all coordinates, if they were given; empty: they follow from momenta
  std::vector<double> velocities{};

  /// of(i) returns the values of the variations, in their order, for the i-th member.
  std::vector<double> of(std::int64_t i) const;
};

}  // namespace least
