// The flow of q̈ = −μ q/r³ over a time, as a change of the state: universal variables, one formula for ellipses,
// parabolas and hyperbolas, for steps of any length and either sign. kepler_change computes the change itself, so short
// steps lose nothing to rounding, and compensated summation of the changes keeps the digits over long runs.
//   q₁ = q₀ + f q₀ + g v₀,  v₁ = v₀ + f′ q₀ + g′ v₀
//   f = −μ G₂/r₀,  g = Δt − μ G₃,  f′ = −μ G₁/(r r₀),  g′ = −μ G₂/r
// where Δt = r₀ G₁ + η G₂ + μ G₃ determines s, η = q₀·v₀, β = 2μ/r₀ − v₀², and G_k are Stumpff's functions of β and s.
// A repelling centre has μ < 0. Motion along a line through the centre is the limit of ellipses, which turn round at
// the centre.
// Source: Stumpff, Himmelsmechanik I, 1959, §41; Danby, Fundamentals of Celestial Mechanics, 1988, 6.9; Wisdom &
// Hernandez, MNRAS 453, 3015 (2015).
#pragma once

#include "core/number/dual.hpp"

namespace least::two_body {

/// KeplerChange has the coefficients f, g, f′ and g′ of the formulas above. f and g′ are those of the sources minus 1.
template <class T>
struct KeplerChange {
  T f{}, g{}, df{}, dg{};
};

/// Returns the change in the time dt from the products q₀·q₀, q₀·v₀, v₀·v₀. Not finite where r₀ = 0, or where squares
/// overflow.
KeplerChange<double> kepler_change(double qq, double qv, double vv, double mu, double dt) noexcept;
/// The same with its derivatives.
KeplerChange<Dual<double, 1>> kepler_change(const Dual<double, 1>& qq, const Dual<double, 1>& qv,
                                            const Dual<double, 1>& vv, double mu, double dt) noexcept;

}  // namespace least::two_body
