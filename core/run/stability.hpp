// Linear stability: the largest ωh that a scheme stands on the harmonic oscillator.
#pragma once

#include <array>
#include <atomic>
#include <cmath>
#include <limits>

#include "core/problems/harmonic_oscillator.hpp"
#include "core/scheme.hpp"

namespace least {

/// The first z = ωh at which powers of the scheme's step matrix on q̈ = −q grow, to 1e-6; 0 where they grow at every z,
/// infinity where none is found up to z = 20.
template <class Scheme>
double measure_stability_bound(const Scheme& scheme) {
  constexpr double most = 20, spacing = 0.01;
  const HarmonicOscillator<> unit;
  const auto stable = [&](double z) {
    double m[2][2];
    for (int k = 0; k < 2; ++k) {
      State<1> x{0, {k == 0 ? 1.0 : 0.0}, {k == 1 ? 1.0 : 0.0}, {}};
      auto stepper = scheme.bind(unit, x);
      if (stepper.step(x, z) != Status::ok) return false;
      m[0][k] = x.q[0];
      m[1][k] = x.p[0];
    }
    const double half = (m[0][0] + m[1][1]) / 2, det = m[0][0] * m[1][1] - m[0][1] * m[1][0];
    const double root = half * half - det;  // eigenvalues half ± √root
    const double radius = root > 0 ? std::abs(half) + std::sqrt(root) : std::sqrt(det);
    return radius <= 1 + 1e-9 * z;
  };
  double low = 0, high = spacing;
  while (stable(high)) {
    if (high > most) return std::numeric_limits<double>::infinity();
    low = high;
    high += spacing;
  }
  if (low == 0) return 0;
  while (high - low > 1e-7) (stable((low + high) / 2) ? low : high) = (low + high) / 2;
  return low;
}

/// The same, measured once per scheme and composition. Thread-safe.
template <class Scheme>
double stability_bound(const Scheme& scheme) {
  static std::array<std::atomic<double>, compositions::names.size()> known{};  // 0: not yet; else 1 + the bound
  std::size_t which = 0;
  if constexpr (requires { scheme.composition; }) which = static_cast<std::size_t>(scheme.composition);
  double bound = known[which].load(std::memory_order_relaxed);
  if (bound == 0) known[which].store(bound = 1 + measure_stability_bound(scheme), std::memory_order_relaxed);
  return bound - 1;
}

}  // namespace least
