// What the map of a run keeps: the symplectic form, or up to a factor the contact form, or else how it changes volumes.
// In contracting motion the factor is far smaller than products of the derivatives from whose differences it would have
// to come, and rounding hides it. The factor of a map is the product of the factors of its parts, however: a run is
// halved until the map of each part shows its own.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "core/run/tangent_map.hpp"
#include "core/variations/sensitivities.hpp"

namespace least::variations {

/// tangent_map returns the map between two states. `by_direction` are the derivatives of the end by all of the card's
/// variables that the motion needs, one after the other.
TangentMap tangent_map(const ParametricScene& equations, const std::vector<double>& start,
                       const std::vector<double>& end, const std::vector<double>& by_direction);

/// Parts gives the maps of parts of a run, between places of it: times, or numbers of steps. These are maps to a fixed
/// time, also where an event ends the run.
struct Parts {
  double from, to;  ///< the places of start and end
  bool by_steps;
  /// of(from, to, start) returns the map of a part from the state there; nothing where it cannot be had.
  std::function<std::optional<TangentMap>(double, double, const std::vector<double>&)> of;
  /// What remains of volumes where the end is moved along the motion to the event that ends the run
  double at_end = 1;
};

/// add_structure reports kind, max_defect and factor of the map of a run. NaN stands for what is not known.
void add_structure(const ParametricScene& equations, const TangentMap& map, const Parts& parts, Sensitivities& found);

}  // namespace least::variations
