// The mechanics that follows from what a problem states: velocities and momenta, energy, forces, equations of motion.
// The notation is that of core/problem.hpp. Contact Hamilton equations: q̇ = H_p, ṗ = −H_q − p H_s, ṡ = p·H_p − H
// (Bravetti, Entropy 19, 535 (2017), eq. 43).
#pragma once

#include "core/problem.hpp"

namespace least {

/// α(t)
template <LinearContact P, class F>
constexpr auto damping(const P& m, const F& f) {
  if constexpr (ConstantDamping<P>) {
    return m.damping();
  } else {
    return m.damping(f);
  }
}

/// ∇V at q and the phase f.
template <Potential P, class T, class F>
constexpr Vec<P::dof, T> gradient(const P& m, const Vec<P::dof, T>& q, const F& f) {
  if constexpr (HasGradient<P>) {
    return m.gradient(q, f);
  } else {
    return m.potential(seed<P::dof, T>(q), f).slope;
  }
}

/// V and ∇V at q of a scene in which neither depends on time.
template <Potential P, class T>
requires Autonomous<P>
constexpr T potential(const P& m, const Vec<P::dof, T>& q) { return m.potential(q, phase(m, 0.0)); }
template <Potential P, class T>
requires Autonomous<P>
constexpr Vec<P::dof, T> gradient(const P& m, const Vec<P::dof, T>& q) { return gradient(m, q, phase(m, 0.0)); }

/// v = g⁻¹ p
template <Potential P, class T>
constexpr Vec<P::dof, T> velocity(const P& m, const Vec<P::dof, T>& q, const Vec<P::dof, T>& p) {
  if constexpr (ConfigurationMetric<P>) {
    return solve_definite(m.metric(q), p, coordinates_of(m));
  } else if constexpr (HasInverseMass<P>) {
    if constexpr (MayHaveFullMass<P>)
      if (m.has_full_mass()) return m.times_inverse_mass(p);
    const auto w = m.inverse_mass();
    Vec<P::dof, T> v;
    for (std::size_t i = 0; i < v.size(); ++i) v[i] = w[i] * p[i];
    return v;
  } else {
    return p;
  }
}

/// p = g v
template <Potential P, class T>
constexpr Vec<P::dof, T> momentum(const P& m, const Vec<P::dof, T>& q, const Vec<P::dof, T>& v) {
  if constexpr (ConfigurationMetric<P>) {
    return m.metric(q) * v;
  } else if constexpr (HasInverseMass<P>) {
    if constexpr (MayHaveFullMass<P>)
      if (m.has_full_mass()) return m.times_mass(v);
    const auto w = m.inverse_mass();
    Vec<P::dof, T> p;
    for (std::size_t i = 0; i < p.size(); ++i) p[i] = v[i] / w[i];
    return p;
  } else {
    return v;
  }
}

/// K + V, the mechanical energy.
template <Potential P, class T, class F>
constexpr T mechanical_energy(const P& m, const Vec<P::dof, T>& q, const Vec<P::dof, T>& p, const F& f) {
  return T(0.5) * dot(p, velocity(m, q, p)) + m.potential(q, f);
}

/// action_energy returns H − K − V, the part of the Hamiltonian that depends on s.
template <Contact P, class T, class F>
constexpr T action_energy(const P& m, const T& s, const F& f) {
  if constexpr (LinearContact<P>) {
    return damping(m, f) * s;
  } else {
    return 0.5 * m.action_curvature() * (s * s) - m.offset();
  }
}
/// H_s
template <Contact P, class T, class F>
constexpr auto action_slope(const P& m, const T& s, const F& f) {
  if constexpr (LinearContact<P>) {
    return damping(m, f);
  } else {
    return m.action_curvature() * s;
  }
}

/// energy returns H(x), or for a flow its energy. Where H depends on s, the state has to carry s.
template <HasEnergy P, class X>
constexpr typename X::Number energy(const P& m, const X& x) {
  if constexpr (Flow<P>) {
    return m.energy(x.y, x.t);
  } else if constexpr (GeneralHamiltonian<P>) {
    return m.hamiltonian(x.q, x.p, x.action.s, phase(m, x.t));
  } else {
    const auto f = phase(m, x.t);
    if constexpr (Contact<P>) {
      static_assert(X::acting, "the energy of a contact scene depends on s");
      return mechanical_energy(m, x.q, x.p, f) + action_energy(m, x.action.s, f);
    } else {
      return mechanical_energy(m, x.q, x.p, f);
    }
  }
}

/// lagrangian_force returns ∂L/∂q at fixed velocity v: −∇V, and where the metric g depends on q also ½ vᵀ(∂g/∂q)v.
template <Potential P, class T, class F>
constexpr Vec<P::dof, T> lagrangian_force(const P& m, const Vec<P::dof, T>& q, const Vec<P::dof, T>& v, const F& f) {
  Vec<P::dof, T> force;
  if constexpr (HasLagrangianForces<P>) {
    force = m.forces()(q, v);
  } else if constexpr (ConfigurationMetric<P>) {
    const auto x = seed<P::dof, T>(q);
    Vec<P::dof, Dual<T, P::dof>> w;
    for (std::size_t i = 0; i < w.size(); ++i) w[i] = v[i];
    force = (T(0.5) * dot(w, m.metric(x) * w) - m.potential(x, f)).slope;
  } else {
    force = gradient(m, q, f);
    for (auto& c : force) c = -c;
  }
  return force;
}

/// derivative returns ẋ. Hamilton's equations: q̇ = ∂H/∂p, ṗ = −∂H/∂q = ∂L/∂q at v = ∂H/∂p; a contact scene adds −p H_s
/// to ṗ, and ṡ = p·q̇ − H where the state carries s. It costs one force evaluation.
template <VectorField P, class X>
constexpr X derivative(const P& m, const X& x) {
  X d;
  d.t = typename X::Time(1);
  const auto f = phase(m, x.t);
  if constexpr (Flow<P>) {
    d.y = m.field(x.y, f);
  } else if constexpr (GeneralHamiltonian<P>) {
    const auto slopes = m.slopes(x.q, x.p, x.action.s, f);
    d.q = slopes.by_p;
    for (std::size_t i = 0; i < d.p.size(); ++i) d.p[i] = -slopes.by_q[i] - x.p[i] * slopes.by_s;
    if (m.reads_action()) d.action.s = dot(x.p, d.q) - m.hamiltonian(x.q, x.p, x.action.s, f);
  } else {
    d.q = velocity(m, x.q, x.p);
    d.p = lagrangian_force(m, x.q, d.q, f);
    if constexpr (LinearContact<P>) {
      const auto alpha = damping(m, f);
      for (std::size_t i = 0; i < d.p.size(); ++i) d.p[i] = d.p[i] - alpha * x.p[i];
    }
    if constexpr (QuadraticContact<P>) {
      const auto slope = action_slope(m, x.action.s, f);
      for (std::size_t i = 0; i < d.p.size(); ++i) d.p[i] = d.p[i] - slope * x.p[i];
    }
    if constexpr (X::acting) d.action.s = 0.5 * dot(x.p, d.q) - m.potential(x.q, f) - action_energy(m, x.action.s, f);
  }
  return d;
}

/// shifted returns x + h d; t is left to the caller.
template <class X>
constexpr X shifted(const X& x, const typename X::Time& h, const X& d) {
  X y = x;
  for (std::size_t i = 0; i < X::size; ++i) y[i] = y[i] + h * d[i];
  return y;
}

}  // namespace least
