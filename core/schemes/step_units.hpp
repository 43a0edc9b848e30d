// Units in which a motion is neither small nor large.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <vector>

#include "core/schemes/least_size.hpp"

namespace least::odeint {

/// StepUnits scale the components of a motion by powers of two, which rounds nothing. Coordinates have one unit,
/// momenta another, an action the product of both: 1, or about their size at the start where that is no usual one.
/// Errors that are absolute in these units are relative to that size.
class StepUnits {
 public:
  /// Whether any unit is not 1.
  explicit operator bool() const { return !units_.empty(); }
  template <class Vector>
  void enter(Vector& y) const {
    for (std::size_t i = 0; i < units_.size(); ++i) y[i] /= units_[i];
  }
  template <class Vector>
  void leave(Vector& y) const {
    for (std::size_t i = 0; i < units_.size(); ++i) y[i] *= units_[i];
  }

  /// settle chooses the units for a motion that starts at y, whose rates are found by rate(y, rates). `coordinates`:
  /// the first components, which as many momenta follow; 0 for a flow. Errors far smaller than the rounding of the
  /// rates cannot be kept to: units are not so small that a `tolerance` asks for that. How much rates are rounded is
  /// seen by their third differences between states that differ by little (Hamming, Introduction to Applied Numerical
  /// Analysis, 1971, 6).
  template <class Vector, class Rate>
  void settle(const Vector& y, std::size_t moving, std::size_t coordinates, double tolerance, Rate&& rate);

 private:
  /// Components with a common unit.
  struct Part {
    std::size_t from, to;
    double size = 0, unit = 1;

    template <class Vector>
    double largest(const Vector& y) const {
      double most = 0;
      for (std::size_t i = from; i < to; ++i) most = std::max(most, std::abs(y[i]));
      return most;
    }
  };

  std::vector<double> units_;  ///< of the components of the motion; empty: 1
};

template <class Vector, class Rate>
void StepUnits::settle(const Vector& y, std::size_t moving, std::size_t coordinates, double tolerance, Rate&& rate) {
  Part parts[] = {{0, coordinates}, {coordinates, 2 * coordinates}, {2 * coordinates, moving}};
  auto& [places, momenta, rest] = parts;
  for (Part& part : parts) part.size = part.largest(y);
  if (std::ranges::all_of(parts, usual_size, &Part::size)) return;
  Vector rates[] = {y, y, y, y}, beside = y;
  rate(y, rates[0]);
  if (places.size > 0 && momenta.size == 0) {  // at rest; velocities are linear in small momenta
    for (std::size_t i = coordinates; i < 2 * coordinates; ++i) beside[i] = rates[0][i];
    rate(beside, rates[1]);
    const double acceleration = places.largest(rates[1]);
    if (acceleration > 0) momenta.size = std::sqrt(places.size / acceleration) * momenta.largest(rates[0]);
  }
  double time = 0;  // in which the motion changes by its size
  for (const Part& part : parts)
    if (const double speed = part.largest(rates[0]); speed > 0) time = std::max(time, part.size / speed);
  constexpr double by_chance = 1e-3;  // what starts so near to 0 does not stay there
  for (Part& part : parts)
    if (const double moved = time * part.largest(rates[0]); part.size < std::min(1.0, by_chance * moved))
      part.size = std::min(1.0, moved);
  if (coordinates > 0) rest.size = std::max(rest.size, places.size * momenta.size);
  double fastest = 0;  // inverse of a time
  for (Part& part : parts) {
    if (!usual_size(part.size)) part.unit = part.size;
    fastest = std::max(fastest, part.largest(rates[0]) / part.unit);
  }
  constexpr double apart = 0x1p-20;
  for (std::size_t k = 1; k < std::size(rates); ++k) {
    beside = y;
    for (std::size_t i = 0; i < moving; ++i) beside[i] *= 1 + static_cast<double>(k) * apart;
    rate(beside, rates[k]);
  }
  units_.assign(moving, 1);
  for (const Part& part : parts) {
    double rounded = 0;
    for (std::size_t i = part.from; i < part.to; ++i)
      rounded = std::max(rounded, std::abs(rates[3][i] - 3 * rates[2][i] + 3 * rates[1][i] - rates[0][i]));
    const double resolved = fastest > 0 ? std::min(rounded / (fastest * tolerance), 1.0) : 0;
    const double unit = std::exp2(std::floor(std::log2(std::max(resolved, part.unit))));
    for (std::size_t i = part.from; i < part.to; ++i) units_[i] = unit;
  }
}

}  // namespace least::odeint
