// Terms −k/r of a potential, found on its tape: c u^(−1/2) where u is a square of a distance in the plane or in space.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "core/tape/tape.hpp"

namespace least::text {

/// c uᵉ, as far as a node is one; else it is its own u.
struct Monomial {
  double factor = 1;
  tape::Index base = tape::none;  ///< u; none for a number
  double exponent = 0;

  static Monomial of(const tape::Tape& tape, tape::Index i);
};

/// −k/r between two places, of each axis two coordinates, or to a fixed one, of each axis one.
struct Attraction {
  static constexpr int fixed = -1;

  double strength = 0;                    ///< k
  std::vector<std::pair<int, int>> axes;  ///< numbers of coordinates; the second of a fixed place is `fixed`
  std::vector<double> centre;             ///< that place, on these axes; empty: there is none

  bool is_fixed() const { return !centre.empty(); }

  /// Nothing where a term is no such.
  static std::optional<Attraction> of(const tape::Tape& tape, const Monomial& term);
};

}  // namespace least::text
