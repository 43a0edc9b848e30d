// Terms −k/r of a potential, found on its tape: c u^(−1/2) where u is a square of a distance in the plane or in space.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "core/tape/tape.hpp"

namespace least::text {

/// Monomial is a node of the tape written as c uᵉ. A node that has no such form is its own base u, with c = e = 1.
struct Monomial {
  double factor = 1;
  tape::Index base = tape::none;  ///< the node u; none where the monomial is a number
  double exponent = 0;

  static Monomial of(const tape::Tape& tape, tape::Index i);
};

/// Attraction is a term −k/r, r being the distance of two moving places (two coordinates on each axis), or of a moving
/// place from a fixed one (one coordinate on each axis).
struct Attraction {
  static constexpr int fixed = -1;

  double strength = 0;  ///< k
  /// by axis, the numbers of its two coordinates; the second is `fixed` where the other place is fixed
  std::vector<std::pair<int, int>> axes;
  std::vector<double> centre;  ///< the fixed place, axis by axis; empty where both places move

  bool is_fixed() const { return !centre.empty(); }

  /// of(tape, c uᵉ) returns the attraction that the term is, or nothing where the term is no −k/r.
  static std::optional<Attraction> of(const tape::Tape& tape, const Monomial& term);
};

}  // namespace least::text
