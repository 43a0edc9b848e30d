// The members of an ensemble: each a scene that differs from the others in the values of a few quantities, which follow
// from the seed and the member's index alone.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/run/request.hpp"

namespace least {

/// How a quantity varies. Grids and values form their product, the last one fastest, which members beyond it go through
/// again; the others are drawn.
enum class Spread : std::uint8_t { grid, values, uniform, normal, logistic };
inline constexpr std::array<std::string_view, 5> spread_names{"grid", "values", "uniform", "normal", "logistic"};

/// What varies: a variable of the start, the velocity of a coordinate, or a parameter of the problem.
enum class Varied : std::uint8_t { variable, velocity, parameter };

struct Variation {
  Varied of = Varied::variable;
  std::size_t index = 0;  ///< among those of the card; of a velocity that of its coordinate
  Spread spread = Spread::grid;
  /// grid: first, last, how many; values: all of them; uniform: from, to; normal: mean, standard deviation; logistic:
  /// mean, scale.
  std::vector<double> numbers;

  bool is_parameter() const { return of == Varied::parameter; }
  bool drawn() const { return spread > Spread::values; }
  /// How many values it takes where it is not drawn.
  std::int64_t size() const;
};

/// The inverse of the normal distribution function, to 1e-15 of its value, for 0 < p < 1. The same bits on every
/// machine. Source: Wichura, Algorithm AS 241, Appl. Statist. 37, 477 (1988).
double normal_quantile(double p);
/// ln(p/(1 − p)), the same of the logistic distribution.
double logistic_quantile(double p);

struct Members {
  std::int64_t count = 0;
  std::uint64_t seed = 0;
  std::vector<Variation> vary;
  /// Of their starts members have the velocities in common, where momenta would depend on what varies, and not the
  /// momenta.
  bool holds_velocities = false;
  std::vector<double> velocities{};  ///< of all coordinates, as given; empty: they follow from momenta

  /// The values of what varies, in its order, for the i-th member.
  std::vector<double> of(std::int64_t i) const;
};

}  // namespace least
