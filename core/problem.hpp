// What a problem can offer, as concepts.
//
// A problem is `template <class R = double> struct X` in namespace least::problems. Its members are its parameters and
// nothing else: numbers R, which may also be lanes or dual numbers, and enumerations for choices. It states its
// mechanics once, generic in R, in the number T of the state and in the number S of time. Code may branch on a choice,
// but not on a number, which may be lanes: select or either does that. Every problem is of one of these kinds:
//
// Mechanical, `dof` degrees of freedom:
//   potential(q, t)       V, the primary form; the compiler finds out whether it depends on the time (`Autonomous`)
//   inverse_mass()        diagonal of g⁻¹ where the constant kinetic metric g is not the identity
//   has_full_mass(), times_inverse_mass(p), times_mass(v)   where a constant g may be full, which is known only at run
//                         time: whether it is, g⁻¹p and g v
//   metric(q)             g(q), symmetric and positive definite, where it depends on the configuration
//   gradient(q, t)        ∇V by hand, where that is faster (a law test checks it against the potential)
//   forces()              where g depends on q: ∂L/∂q as a function of (q, v), where there is one
//   exact(x0, t)          the solution, where there is a closed form (scalar numbers only); `exact_applies(x0)` says
//                         for which starts, where it does not hold for all
//   invariants(q, p, t)   what the exact motion conserves besides energy
// Contact, the same with one of
//   damping() or damping(t)           α: H = K + V + α(t) s; the motion in (q, p) never reads s
//   damping_integral(t)               ∫α dt up to the time t (never a phase), where it has a closed form (a law test
//                                     checks it)
//   action_curvature() and offset()   γ and R: H = K + V + γs²/2 − R
// General, `dof` degrees of freedom:
//   hamiltonian(q, p, s, t)           H, and
//   slopes(q, p, s, t)                its first derivatives
//   lagrangian(q, v, s, t)            where it is known: L with its first derivatives
//   coordinates(), reads_action()     the number of its coordinates; whether the motion depends on s (else s rests)
// Flow, `dim` variables, not mechanical:
//   field(y, t)                       ẏ
//   flow(Piece<i>, y, h, t)           `pieces` exact flows over h, time frozen at t, whose fields add up to ẏ
//   energy(y, t)                      where there is one; `keeps_energy` where the motion keeps it
//
// For all:
//   phases(t)             what the mechanics needs to know of a time, where that is expensive to compute; it takes the
//                         place of t in every function above, and is computed once a step. `period()`: its period.
//   frequency_squared(q)  estimate of the largest squared local frequency, where a step can be too long for it
//   careful_step          the ωh from which a run warns, where that has to be below half the stability bound
// Everything else (vector field, Hamiltonian, Lagrangian, their derivatives) follows: core/equations.hpp.
// Notation: K = ½ g_ij v^i v^j = ½ pᵀg⁻¹p, H = K + V (+ αs | + γs²/2 − R), L = p·v − H. Contact form η = ds − p·dq.
#pragma once

#include <concepts>
#include <type_traits>

#include "core/number/dependence.hpp"
#include "core/number/vector.hpp"
#include "core/state.hpp"

namespace least {

template <class P>
concept HasPhases = requires(const P& m, double t) {
  m.phases(t);
};
/// phase(m, t) returns what the mechanics needs to know of the time t: m.phases(t), or t itself.
template <class P, class S>
constexpr auto phase(const P& m, const S& t) {
  if constexpr (HasPhases<P>) {
    return m.phases(t);
  } else {
    return t;
  }
}

template <class P>
concept Potential = requires(const P& m, const Vec<P::dof>& q) {
  { m.potential(q, phase(m, 0.0)) } -> std::convertible_to<double>;
};
template <class P>
concept ConfigurationMetric = Potential<P> && requires(const P& m, const Vec<P::dof>& q) {
  { m.metric(q) } -> std::same_as<Mat<P::dof>>;
};
/// HasLagrangianForces: forces() returns ∂L/∂q at fixed v as a function of (q, v) that does not refer to the problem,
/// so that it outlives it.
template <class P>
concept HasLagrangianForces = ConfigurationMetric<P> && requires(const P& m, const Vec<P::dof>& q) {
  { m.forces()(q, q) } -> std::same_as<Vec<P::dof>>;
};
/// ConstantDamping: α is constant in time, so values derived from it are computed once a run.
template <class P>
concept ConstantDamping = Potential<P> && requires(const P& m) {
  m.damping();
};
/// H = K + V + α(t) s
template <class P>
concept LinearContact = ConstantDamping<P> ||(Potential<P>&& requires(const P& m) { m.damping(phase(m, 0.0)); });
/// H = K + V + γs²/2 − R: the motion reads s.
template <class P>
concept QuadraticContact = Potential<P> && requires(const P& m) {
  m.action_curvature();
  m.offset();
};
template <class P>
concept Contact = LinearContact<P> || QuadraticContact<P>;
/// H = K + V: no s anywhere.
template <class P>
concept Conservative = Potential<P> && !Contact<P>;
/// H = ½ pᵀg⁻¹p + V(q, t) with a constant metric g: kicks and drifts are explicit.
template <class P>
concept Separable = Conservative<P> && !ConfigurationMetric<P>;
/// H = ½ pᵀg⁻¹p + V(q, t) + a function of s, with a constant metric.
template <class P>
concept SeparableContact = Contact<P> && !ConfigurationMetric<P>;

/// ∂H/∂q, ∂H/∂p and ∂H/∂s.
template <int N, class T>
struct HamiltonianSlopes {
  Vec<N, T> by_q, by_p;
  T by_s;
};
/// GeneralHamiltonian: any H(q, p, s, t) of no particular form. The state always carries s, which stays constant where
/// reads_action() is false.
template <class P>
concept GeneralHamiltonian = requires(const P& m, const Vec<P::dof>& q) {
  { m.hamiltonian(q, q, 0.0, phase(m, 0.0)) } -> std::convertible_to<double>;
  m.slopes(q, q, 0.0, phase(m, 0.0));
};

template <class P>
concept Flow = requires(const P& m, const Vec<P::dim>& y) {
  { m.field(y, phase(m, 0.0)) } -> std::same_as<Vec<P::dim>>;
};
/// Has equations of motion ẏ = f(t, y).
template <class P>
concept VectorField = Potential<P> || GeneralHamiltonian<P> || Flow<P>;

namespace detail {
/// WithParameters<P, R>::type is the problem P with parameters that are numbers R.
template <class P, class R>
struct WithParameters {
  using type = P;
};
template <template <class> class P, class Own, class R>
struct WithParameters<P<Own>, R> {
  using type = P<R>;
};
/// SaysReadsTime: a problem whose mechanics is known only at run time declares itself whether it depends on time.
template <class P>
concept SaysReadsTime = requires {
  P::reads_time;
};
/// potential_reads_time() returns whether V or ∇V depends on the time t explicitly: it evaluates them in numbers that
/// track dependence on t.
template <Potential P>
constexpr bool potential_reads_time() {
  if constexpr (SaysReadsTime<P>) {
    return P::reads_time;
  } else {
    const typename WithParameters<P, double>::type m{};
    const auto f = phase(m, Dependence::touching());
    const Vec<P::dof, Dependence> q{};
    Dependence seen = m.potential(q, f);
    if constexpr (requires { m.gradient(q, f); })
      for (const Dependence& slope : m.gradient(q, f)) seen = seen | slope;
    return seen.touched;
  }
}
/// reads_time() returns the same for all of the mechanics of P.
template <class P>
constexpr bool reads_time() {
  if constexpr (SaysReadsTime<P>) {
    return P::reads_time;
  } else {
    const typename WithParameters<P, double>::type m{};
    const auto f = phase(m, Dependence::touching());
    Dependence seen;
    if constexpr (Potential<P>) {
      seen.touched = potential_reads_time<P>();
      if constexpr (LinearContact<P> && !ConstantDamping<P>) seen = seen | m.damping(f);
    } else {
      for (const Dependence& rate : m.field(Vec<P::dim, Dependence>{}, f)) seen = seen | rate;
    }
    return seen.touched;
  }
}
}  // namespace detail

/// Autonomous: the equations of motion do not depend on the time, as the compiler finds out. That is a matter of their
/// form, not of their parameters: equations with a drive of amplitude 0 are not autonomous.
template <class P>
concept Autonomous = VectorField<P> && !detail::reads_time<P>();
/// PotentialReadsTime: V depends on the time.
template <class P>
concept PotentialReadsTime = Potential<P> && detail::potential_reads_time<P>();

/// Piece<i> names part i of the field of a split flow.
template <int I>
using Piece = std::integral_constant<int, I>;
/// SplitFlow: the field is a sum of parts with known exact flows.
template <class P>
concept SplitFlow = Flow<P> && requires(const P& m, const Vec<P::dim>& y) {
  { m.flow(Piece<P::pieces - 1>{}, y, 0.0, phase(m, 0.0)) } -> std::same_as<Vec<P::dim>>;
};
namespace detail {
template <class P, class T, class S, bool Full>
struct StateFor;
template <Conservative P, class T, class S, bool Full>
struct StateFor<P, T, S, Full> {
  using type = State<P::dof, T, S>;
};
template <Contact P, class T, class S, bool Full>
struct StateFor<P, T, S, Full> {
  using type = State<P::dof, T, S, std::conditional_t<Full || QuadraticContact<P>, Action<T>, NoAction>>;
};
template <GeneralHamiltonian P, class T, class S, bool Full>
struct StateFor<P, T, S, Full> {
  using type = State<P::dof, T, S, Action<T>>;
};
template <Flow P, class T, class S, bool Full>
struct StateFor<P, T, S, Full> {
  using type = Point<P::dim, T, S>;
};
}  // namespace detail

/// coordinates_of returns the number of coordinates of a scene, which is smaller than P::dof where its class has room
/// for more.
template <class P>
constexpr std::size_t coordinates_of([[maybe_unused]] const P& m) {
  if constexpr (requires { m.coordinates(); }) {
    return m.coordinates();
  } else {
    return std::size_t(P::dof);
  }
}

/// has_component returns whether the scene has component i of its state; where the class has room for more components
/// than the scene has, the others stay constant.
template <class P>
constexpr bool has_component([[maybe_unused]] const P& m, [[maybe_unused]] std::size_t i) {
  if constexpr (GeneralHamiltonian<P>)
    if (i == 2 * P::dof) return m.reads_action();
  if constexpr (requires { m.coordinates(); }) {
    if constexpr (Flow<P>) return i < m.coordinates();
    if constexpr (!Flow<P>) return i == 2 * P::dof || i % P::dof < m.coordinates();
  }
  return true;
}

/// StateOf is the state that the motion needs.
template <class P, class T = double, class S = double>
using StateOf = typename detail::StateFor<P, T, S, false>::type;
/// FullStateOf also carries s wherever the scene has one.
template <class P, class T = double, class S = double>
using FullStateOf = typename detail::StateFor<P, T, S, true>::type;

template <class P>
concept HasGradient = requires(const P& m, const Vec<P::dof>& q) {
  m.gradient(q, phase(m, 0.0));
};
template <class P>
concept HasDampingIntegral = LinearContact<P> && requires(const P& m) {
  m.damping_integral(0.0);
};
template <class P>
concept HasInverseMass = requires(const P& m) {
  m.inverse_mass();
};
/// The constant metric is diagonal, or full where has_full_mass() says so.
template <class P>
concept MayHaveFullMass = HasInverseMass<P> && requires(const P& m, const Vec<P::dof>& x) {
  { m.has_full_mass() } -> std::same_as<bool>;
  { m.times_inverse_mass(x) } -> std::same_as<Vec<P::dof>>;
  { m.times_mass(x) } -> std::same_as<Vec<P::dof>>;
};
/// The coordinates of a state: q, or all of a point.
template <class X>
constexpr const auto& position(const X& x) {
  if constexpr (requires { x.q; }) {
    return x.q;
  } else {
    return x.y;
  }
}
template <class P>
concept HasFrequency = requires(const P& m, const StateOf<P>& x) {
  m.frequency_squared(position(x));
};
namespace detail {
template <class P>
constexpr bool frequency_reads_place() {
  std::remove_cvref_t<decltype(position(StateOf<P, Dependence>{}))> q;
  q.fill(Dependence::touching());
  return Dependence(typename WithParameters<P, Dependence>::type{}.frequency_squared(q)).touched;
}
}  // namespace detail
/// ConstantFrequency: frequency_squared(q) does not depend on q, as for a linear oscillation or a global bound.
template <class P>
concept ConstantFrequency = HasFrequency<P> && !detail::frequency_reads_place<P>();
/// invariants_at returns the conserved quantities besides the energy: invariants(q, p, t), or invariants(y, t) of a
/// flow.
template <class P, class X>
constexpr auto invariants_at(const P& m, const X& x) {
  if constexpr (requires { m.invariants(x.q, x.p, x.t); }) {
    return m.invariants(x.q, x.p, x.t);
  } else {
    return m.invariants(x.y, x.t);
  }
}
template <class P>
concept HasInvariants = requires(const P& m, const StateOf<P>& x) {
  m.invariants(x.q, x.p, x.t);
}
|| requires(const P& m, const StateOf<P>& x) { m.invariants(x.y, x.t); };
template <class P>
concept HasExact = requires(const P& m, const StateOf<P>& x) {
  { m.exact(x, 0.0) } -> std::same_as<StateOf<P>>;
};
template <class P>
concept HasEnergy = Potential<P> || GeneralHamiltonian<P> || requires(const P& m, const Vec<P::dim>& y) {
  { m.energy(y, 0.0) } -> std::convertible_to<double>;
};
/// The exact motion keeps the energy.
template <class P>
concept KeepsEnergy = (Conservative<P> && Autonomous<P>) || requires {
  requires P::keeps_energy;
};

}  // namespace least
