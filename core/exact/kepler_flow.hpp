// The flow of q̈ = −μ q/r³ over a time, as a change of the state: universal variables, one formula for ellipses,
// parabolas and hyperbolas, for steps of any length and either sign. As the change is what is computed, short steps
// lose nothing to rounding, and who sums the changes with what rounding has left of them keeps the digits over long
// runs.
//   q₁ = q₀ + f q₀ + g v₀,  v₁ = v₀ + f′ q₀ + g′ v₀
//   f = −μ G₂/r₀,  g = Δt − μ G₃,  f′ = −μ G₁/(r r₀),  g′ = −μ G₂/r
// where Δt = r₀ G₁ + η G₂ + μ G₃ says how far s is, η = q₀·v₀, β = 2μ/r₀ − v₀², and G_k are Stumpff's functions of β
// and s. A repelling centre has μ < 0. A line through the centre is gone along as the limit of ellipses, which turn
// round at it.
// Source: Stumpff, Himmelsmechanik I, 1959, §41; Danby, Fundamentals of Celestial Mechanics, 1988, 6.9; Wisdom &
// Hernandez, MNRAS 453, 3015 (2015).
#pragma once

#include "core/number/dual.hpp"

namespace least::two_body {

/// The four coefficients; f and g′ are short of those in print by 1.
template <class T>
struct KeplerChange {
  T f{}, g{}, df{}, dg{};
};

/// Of a body whose place and velocity have these products q₀·q₀, q₀·v₀, v₀·v₀. Not finite where r₀ = 0, or where
/// squares overflow.
KeplerChange<double> kepler_change(double qq, double qv, double vv, double mu, double dt) noexcept;
/// The same, and its derivatives.
KeplerChange<Dual<double, 1>> kepler_change(const Dual<double, 1>& qq, const Dual<double, 1>& qv,
                                            const Dual<double, 1>& vv, double mu, double dt) noexcept;

}  // namespace least::two_body
