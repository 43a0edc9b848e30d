// Friction between bodies acts on differences of their velocities: it jumps with none of their momenta, but with one of
// other momenta in which the kinetic energy is diagonal as well.
#pragma once

#include <memory>
#include <vector>

#include "core/text/sized_scene.hpp"

namespace least {

/// TurnedMomenta are momenta y = T p in which each friction between bodies jumps with one of them alone (such as the
/// forces −c sign(vx − vy) on one body and c sign(vx − vy) on the other): one for each such difference of velocities,
/// and others that do not change it. K = Σ y²/2m in them.
struct TurnedMomenta {
  std::vector<double> to, back;  ///< T and its inverse, n × n, row-major
  std::vector<double> inverse_mass;
  std::vector<bool> jumping;  ///< for each, whether its force jumps

  /// Null if forces jump with each momentum of the scene alone, or in another way: with differences that share a body,
  /// or not against the velocity with which they jump.
  static std::shared_ptr<const TurnedMomenta> of(const text::SizedScene& scene);
};
/// knows_rest returns whether kicks can decide what jumping forces hold at rest.
bool knows_rest(const text::SizedScene& scene);

/// Writes b = A a for a square matrix, row-major.
void multiply(const std::vector<double>& matrix, const double* a, double* b);

}  // namespace least
