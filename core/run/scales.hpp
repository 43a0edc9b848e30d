// How long, how strong and how wide a motion is near its start, in the units of its scene: what defaults are measured
// by, so that a scene behaves the same in metres and seconds, in nanometres and femtoseconds, or in any other units.
// Where the problem is an orbit about an attracting centre these follow from its energy; elsewhere from the Taylor
// series of the motion at its start.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "core/run/mechanics.hpp"
#include "core/schemes/taylor.hpp"

namespace least {

/// From Taylor coefficients of a motion at its start, `orders[k][i]` that of the order k of the i-th variable. Of the
/// variables the first `coordinates` are looked at; their momenta, if it has any, stand `momenta` places behind; 0: it
/// is a flow.
Scales scales_of_series(std::span<const std::vector<double>> orders, std::size_t coordinates, std::size_t momenta);

/// Of a bound orbit in the plane or in space about a centre of this strength, of a body of mass 1 at the distance r
/// with the square v² of its velocity. Nothing where the orbit is not bound.
Scales scales_of_orbit(double mu, double r, double v_squared);

/// Of a motion from the series of its equations at a start with so many components; `half`: of mechanics the number of
/// its coordinates, of a flow 0.
Scales scales_of_motion(tape::Program program, const double* start, double t, std::size_t components, std::size_t half);

template <class P>
Scales scales_of(const P& problem, const StateOf<P>& start) {
  Scales scales;
  if constexpr (requires { problem.gravitational_parameter(); })
    scales =
        scales_of_orbit(problem.gravitational_parameter(), std::sqrt(dot(start.q, start.q)), dot(start.p, start.p));
  if (!(scales.time > 0)) {
    using X = StateOf<P>;
    constexpr std::size_t half = [] {
      if constexpr (Flow<P>) return std::size_t(0);
      if constexpr (!Flow<P>) return std::size_t(P::dof);
    }();
    scales = scales_of_motion(taylor::record<X>(problem), taylor::values_of(start).data(), start.t, X::size, half);
  }
  if constexpr (HasFrequency<P>)
    if (!(scales.time > 0)) scales.time = 1 / std::sqrt(problem.frequency_squared(position(start)));
  if (!std::isfinite(scales.time)) scales.time = 0;
  scales.damped = LinearContact<P>;
  return scales;
}

}  // namespace least
