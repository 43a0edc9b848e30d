// Friction between bodies acts on differences of their velocities: what it jumps with is no momentum of one body, but
// one of other momenta that have the same kinetic energy.
#pragma once

#include <memory>
#include <vector>

#include "core/text/sized_scene.hpp"

namespace least {

/// Momenta y = T p in which friction between bodies, as −c sign(vx − vy) on one and c sign(vx − vy) on the other, jumps
/// with one of them alone: one for each such difference of velocities, and others that it does not change. K = Σ y²/2m
/// in them.
struct TurnedMomenta {
  std::vector<double> to, back;  ///< T and its inverse, row by row
  std::vector<double> inverse_mass;
  std::vector<bool> jumping;  ///< of each whether its force jumps

  /// Null where forces jump with each momentum alone, and where they jump in another way: with differences that have a
  /// body in common, or not against the velocity that they jump with.
  static std::shared_ptr<const TurnedMomenta> of(const text::SizedScene& scene);
};
/// Whether kicks know what forces that jump hold at rest.
bool knows_rest(const text::SizedScene& scene);

/// b = A a of a square matrix, row by row.
void multiply(const std::vector<double>& matrix, const double* a, double* b);

}  // namespace least
