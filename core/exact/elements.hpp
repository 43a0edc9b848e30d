// Elements are the osculating elements of a body of unit mass: those of the conic that it would follow from here on
// around a centre of attraction μ. Source: Goldstein, Poole, Safko, Classical Mechanics, 2002, sections 3.7 and 3.9.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <string_view>

#include "core/problem.hpp"

namespace least::two_body {

template <int N>
struct Elements {
  Vec<N> lenz;  ///< p × L − μ q/r = (p² − μ/r) q − (q·p) p, of length μe: points to the periapsis
  double semi_major_axis;   ///< negative on a hyperbola; NaN where nothing attracts
  double eccentricity;      ///< NaN where nothing attracts
  double angular_momentum;  ///< in the plane its component along the normal, in space its magnitude
};

template <std::size_t N>
Elements<int(N)> elements(const std::array<double, N>& q, const std::array<double, N>& p, double mu) {
  const double r = std::sqrt(dot(q, q)), pp = dot(p, p), qp = dot(q, p);
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  Elements<int(N)> e;
  for (std::size_t i = 0; i < N; ++i) e.lenz[i] = (pp - mu / r) * q[i] - qp * p[i];
  e.semi_major_axis = mu > 0 ? 1 / (2 / r - pp / mu) : none;
  e.eccentricity = mu > 0 ? std::sqrt(dot(e.lenz, e.lenz)) / mu : none;
  if constexpr (N == 2) {
    e.angular_momentum = q[0] * p[1] - q[1] * p[0];
  } else {
    e.angular_momentum = std::sqrt(r * r * pp - qp * qp);
  }
  return e;
}

/// Below this eccentricity the direction of the periapsis is rounding.
inline constexpr double least_eccentricity = 1e-8;

/// The elements by number; orbits in space have all but the last. element(e, number) is NaN where the element is not
/// defined, or where squares of large numbers overflow.
inline constexpr std::array<std::string_view, 4> element_names{"angular_momentum", "semi_major_axis", "eccentricity",
                                                               "periapsis"};
template <int N>
inline constexpr std::size_t elements_in = N == 2 ? 4 : 3;
template <int N>
double element(const Elements<N>& e, std::size_t number) {
  const bool apsis = e.eccentricity > least_eccentricity;  // its angle, in (−π, π]
  const double all[] = {e.angular_momentum, e.semi_major_axis, e.eccentricity,
                        apsis ? std::atan2(e.lenz[1], e.lenz[0]) : std::numeric_limits<double>::quiet_NaN()};
  return std::isfinite(all[number]) ? all[number] : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace least::two_body
