// lifted_splitting: explicit contact maps for H = S(q, p, t) + p·X(q, s, t) − g(q, s, t), which has an explicit step of
// its own for each half:
//   S = ½ pᵀM⁻¹p + V(q, t): drift q += h M⁻¹p, s += hK and kick p −= h∇V, s −= hV, maps with λ = 1
//   p·X − g: any one-step method Φ for y = (q, s), q̇ = X, ṡ = g, with the contact elements that it takes along,
//     (−P, 1) = λ(−p, 1)(DΦ)⁻¹, DΦ being the exact derivative of Φ
// The second is a contact map for every Φ and every step, whatever its order; where X does not read s and g = 0 it is
// Φ's cotangent lift, P = p (DΦ)⁻¹, and all is symplectic. Strang: kick, drift, lift, drift, kick, one force a step;
// symmetric where Φ is, order 2, and by compositions up to 10. Time goes on in the lift. Look-alikes: p taken along by
// its own equation with the same method is no contact map; Φ of a lower order than the composition is one, but keeps
// the order only where it is symmetric.
// Source: Kevrekidis, arXiv 2605.09103 (2026); Strang, SIAM J. Numer. Anal. 5, 506 (1968).
#pragma once

#include <memory>
#include <tuple>

#include "core/scheme.hpp"
#include "core/schemes/lifted_map.hpp"

namespace least {

/// A scene as text, whose lift() is null unless it has the form.
template <class P>
concept MayBeLifted = GeneralHamiltonian<P> && requires(const P& m) {
  { m.lift() } -> std::convertible_to<std::shared_ptr<const text::Lift>>;
};

template <MayBeLifted P, class X>
class LiftedStepper {
 public:
  using T = typename X::Number;

  LiftedStepper(const P& problem, const X& x, const Composition& composition, LiftMethod method)
      : map_(problem.lift(), composition, method), reads_action_(problem.reads_action()) {
    map_.begin(x.q.data(), x.t, slope_.data());
  }
  StepStatus step(X& x, double h) noexcept {
    X y = x;
    T* const s = reads_action_ ? &y.action.s : nullptr;
    const StepStatus status = map_.step({y.q.data(), y.p.data(), s, slope_.data()}, x.t, h);
    if (status == StepStatus::ok) x = y;
    return status;
  }
  const Work& work() const { return map_.work(); }

 private:
  LiftedMap<T> map_;
  bool reads_action_;
  std::array<T, std::size_t(P::dof + 1)> slope_{};  ///< ∇V and V at the state
};

struct LiftedSplitting {
  double step = 0.01;
  Composition composition = Composition::none;
  LiftMethod lift = LiftMethod::automatic;
  static constexpr std::tuple fields{
      step_field<LiftedSplitting>(), composition_field<LiftedSplitting>(),
      Field<LiftedSplitting, LiftMethod>{
          "lift",
          "",
          "",
          "how what is linear in the momenta moves the coordinates: exact, by the matrix "
          "exponential, where that is linear with constant coefficients; midpoint, the "
          "implicit rule for the coordinates and s alone; extrapolation, explicit and of "
          "the composition's order, not symmetric; automatic: exact, else midpoint",
          &LiftedSplitting::lift,
          {0, 0},
          lift_names}};
  static SchemeCard card();
  static bool takes(const ProblemCard& problem) { return problem.lift != Lifted::no; }
  std::vector<Conflict> conflicts(const ProblemCard& problem) const;
  template <MayBeLifted P, class X>
  requires std::is_same_v<typename X::Time, double> &&
      (std::is_same_v<typename X::Number, double> ||
       std::is_same_v<typename X::Number, Slope>)auto bind(const P& problem, const X& x) const {
    return LiftedStepper<P, X>(problem, x, composition, lift);
  }
  template <MayBeLifted P>
  std::string unsupported_reason(const P& problem) const {
    return problem.lift() ? ""
                          : "the Hamiltonian has terms that are neither linear in the momenta nor quadratic with "
                            "constant coefficients";
  }
};

}  // namespace least
