// The characteristic time, energy and length of a motion near its start, in the units of its scene. Defaults are scaled
// by them, so that a scene behaves the same in metres and seconds, in nanometres and femtoseconds, or in any other
// units. For an orbit about an attracting centre they follow from its energy; otherwise from the Taylor series of the
// motion at its start.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "core/run/mechanics.hpp"
#include "core/schemes/taylor.hpp"

namespace least {

/// scales_of_series computes the scales from Taylor coefficients of a motion at its start; `orders[k][i]` is that of
/// order k of variable i. The first `coordinates` variables are looked at; the momentum of variable i is variable i +
/// `momenta`, or for a flow `momenta` is 0.
Scales scales_of_series(std::span<const std::vector<double>> orders, std::size_t coordinates, std::size_t momenta);

/// scales_of_orbit returns the scales of an orbit about a centre of strength mu, of a body of unit mass at the distance
/// r with the squared speed v_squared; of one far larger than r, or not bound, those of its part near the start.
Scales scales_of_orbit(double mu, double r, double v_squared);

/// scales_of_motion computes the scales from the series of the equations at a start with so many components; `half` is
/// the number of coordinates of mechanics, 0 for a flow.
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
