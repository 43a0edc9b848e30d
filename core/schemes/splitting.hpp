// Explicit splitting of a separable Hamiltonian H = K(p) + V(q, t) into kicks p −= b h ∇V(q, t), drifts q += a h g⁻¹p:
//   symplectic_euler  kick h, drift h                            order 1
//   leapfrog          kick h/2, drift h, kick h/2                order 2, symmetric (Störmer–Verlet, velocity form)
//   ruth_3            (drift, kick) = (7/24, 2/3), (3/4, −2/3), (−1/24, 1)   order 3
// The time goes with the drifts, so that a kick reads the potential where the drifts have come: leapfrog at both ends.
// Symplectic; angular momentum is kept exactly; leapfrog and its compositions are time-reversible. The force at the end
// of a step is the force at the start of the next: one evaluation per drift. They assume that the step resolves the
// fastest oscillation and cannot check it: leapfrog is stable for ωh < 2. Look-alike: leapfrog in the drift–kick–drift
// order is a different map, conjugate to this one.
// Sources: Hairer, Lubich, Wanner 2006, VI.3 and I.1.4; Ruth, IEEE Trans. Nucl. Sci. NS-30, 2669 (1983), eq. 18.
#pragma once

#include <initializer_list>
#include <tuple>

#include "core/scheme.hpp"

namespace least {

/// kick₀, drift₀, kick₁, drift₁, …, kick_n as fractions of the step. Kicks that meet in a composition are one kick.
template <class S>
struct Sequence {
  int drifts = 0;
  std::array<S, compositions::most_stages + 1> kick{};
  std::array<S, compositions::most_stages> drift{};
  std::array<S, compositions::most_stages> node{};  ///< time at the end of a drift, as a fraction of the step

  struct Piece {
    S before, over, after;  ///< kick, drift, kick
  };
  Sequence(std::initializer_list<Piece> pieces = {}) {
    for (const Piece& piece : pieces) append(piece);
  }
  void append(const Piece& piece) {
    const auto i = static_cast<std::size_t>(drifts++);
    kick[i] = kick[i] + piece.before;
    drift[i] = piece.over;
    node[i] = i == 0 ? piece.over : node[i - 1] + piece.over;
    kick[i + 1] = piece.after;
  }
};

template <Separable P, class X>
class KickDrift {
 public:
  using T = typename X::Number;
  using S = typename X::Time;

  /// The sequence has to outlive the stepper, which is copied often and so refers to it.
  KickDrift(const P& problem, const X& x, const Sequence<S>& sequence) : problem_(problem), sequence_(&sequence) {
    slope_ = gradient(problem_, x.q, phase(problem_, x.t));
    ++work_.forces;
    if constexpr (MayHaveFullMass<P>) mass_ = {problem_.inverse_mass(), problem_.has_full_mass()};
  }

  StatusOf<T> step(X& x, const S& h) noexcept {
    kick(x, h * sequence_->kick[0]);
    std::size_t i = 0;
    do {  // there is at least one drift: what a driver computes at the end can then share the work of the last force
      drift(x, h * sequence_->drift[i]);
      slope_ = gradient(problem_, x.q, phase(problem_, x.t + h * sequence_->node[i]));
      ++work_.forces;
      kick(x, h * sequence_->kick[i + 1]);
    } while (++i < static_cast<std::size_t>(sequence_->drifts));
    return StepStatus::ok;
  }
  const Work& work() const { return work_; }
  /// Calls f with each number kept that belongs to the state; a lane that moves to another stepper takes these along.
  template <class F>
  void each_kept(F&& f) {
    for (T& component : slope_) f(component);
  }

 private:
  void kick(X& x, const S& h) const {
    for (std::size_t i = 0; i < x.p.size(); ++i) x.p[i] = x.p[i] - h * slope_[i];
  }
  void drift(X& x, const S& h) const {
    if constexpr (MayHaveFullMass<P>) {
      if (mass_.full) {
        const auto v = problem_.times_inverse_mass(x.p);
        for (std::size_t i = 0; i < x.q.size(); ++i) x.q[i] = x.q[i] + h * v[i];
      } else {
        for (std::size_t i = 0; i < x.q.size(); ++i) x.q[i] = x.q[i] + (h * mass_.inverse[i]) * x.p[i];
      }
    } else if constexpr (HasInverseMass<P>) {
      const auto w = problem_.inverse_mass();
      for (std::size_t i = 0; i < x.q.size(); ++i) x.q[i] = x.q[i] + (h * w[i]) * x.p[i];
    } else {
      for (std::size_t i = 0; i < x.q.size(); ++i) x.q[i] = x.q[i] + h * x.p[i];
    }
  }

  /// The inverse mass, looked up once where it is known at run time only.
  struct Mass {
    Vec<P::dof> inverse;
    bool full;
  };
  struct Known {};

  P problem_;
  const Sequence<S>* sequence_;
  Vec<P::dof, T> slope_{};  ///< ∇V at the state's q
  [[no_unique_address]] std::conditional_t<MayHaveFullMass<P>, Mass, Known> mass_{};
  Work work_;
};

/// E_d of a step of length h of the trapezoidal rule from a to b: the momentum ḡv of its drift is p₀ after half a kick,
/// and p₁ before the other half.
template <Separable P, class X>
typename X::Number trapezoid_energy(const P& problem, const X& a, const X& b, const typename X::Time& h) {
  using T = typename X::Number;
  const auto left = phase(problem, a.t), right = phase(problem, a.t + h);
  const auto before = gradient(problem, a.q, left), after = gradient(problem, b.q, right);
  auto p = a.p;
  for (std::size_t i = 0; i < p.size(); ++i) p[i] = 0.5 * (a.p[i] + b.p[i]) + (0.25 * h) * (after[i] - before[i]);
  return T(0.5) * (dot(p, velocity(problem, a.q, p)) + (problem.potential(a.q, left) + problem.potential(b.q, right)));
}

struct SymplecticEuler {
  double step = 0.01;
  static constexpr std::tuple fields{step_field<SymplecticEuler>()};
  static SchemeCard card() {
    return {.id = "symplectic_euler",
            .title = "Symplectic Euler",
            .summary = "Kick, then drift with the new momentum: the simplest symplectic scheme.",
            .orders = {{"", 1}},
            .structure = "symplectic",
            .good_for = "long runs where the picture counts, not the digits; first lessons",
            .fails_when = "accuracy counts (leapfrog costs the same), or ωh > 2",
            .needs = "a separable Hamiltonian: a potential and a constant kinetic metric",
            .references = {"Hairer, Lubich, Wanner 2006, I.1.9"}};
  }
  template <Separable P, class X>
  auto bind(const P& problem, const X& x) const {
    return KickDrift<P, X>(problem, x, sequence<typename X::Time>());
  }
  template <class S>
  static const Sequence<S>& sequence() {
    static const Sequence<S> one{{S(1), S(1), S(0)}};
    return one;
  }
  /// L_d = h L(q₀, v, t₀).
  template <Separable P, class X>
  auto step_energy(const P& problem, const X& a, const X& b, const typename X::Time&) const {
    return mechanical_energy(problem, a.q, b.p, phase(problem, a.t));
  }
};

struct Leapfrog {
  double step = 0.01;
  Composition composition = Composition::none;
  static constexpr std::tuple fields{step_field<Leapfrog>(), composition_field<Leapfrog>()};
  static SchemeCard card() {
    return {
        .id = "leapfrog",
        .title = "Leapfrog (Störmer–Verlet)",
        .summary = "Half a kick, a drift, half a kick: the variational integrator of the trapezoidal rule, explicit.",
        .orders = orders_from(2),
        .symmetric = true,
        .structure = "symplectic",
        .recommended = "kahan_li_6",
        .good_for = "long runs of anything separable: energy error stays bounded, momenta are kept, one force a step",
        .fails_when = "ωh ≥ 2, or the motion is fast for a short time only (periapsis passages): the ellipse precesses",
        .needs = "a separable Hamiltonian: a potential and a constant kinetic metric",
        .references = {"Hairer, Lubich, Wanner 2006, I.1.4", "Marsden, West, Acta Numerica 10, 357 (2001), 2.3.1"}};
  }
  template <Separable P, class X>
  auto bind(const P& problem, const X& x) const {
    return KickDrift<P, X>(problem, x, sequence<typename X::Time>());
  }
  template <Separable P, class X>
  auto step_energy(const P& problem, const X& a, const X& b, const typename X::Time& h) const {
    return trapezoid_energy(problem, a, b, h);
  }

  template <class S>
  const Sequence<S>& sequence() const {
    const auto composed = [](const Weights<S>& weights) {
      Sequence<S> all;
      for (std::size_t i = 0; i < static_cast<std::size_t>(weights.stages); ++i)
        all.append({weights.gamma[i] / 2, weights.gamma[i], weights.gamma[i] / 2});
      return all;
    };
    if (!composition.weights().empty()) {
      const auto& weights = Weights<S>::of(composition);
      return composition.kept<Sequence<S>>([&] { return composed(weights); });
    }
    static const auto table = [&] {
      std::array<Sequence<S>, compositions::names.size()> all;
      for (std::size_t c = 0; c < all.size(); ++c) all[c] = composed(Weights<S>::of(static_cast<Composition>(c)));
      return all;
    }();
    return table[static_cast<std::size_t>(composition)];
  }
};

struct Ruth3 {
  double step = 0.01;
  static constexpr std::tuple fields{step_field<Ruth3>()};
  static SchemeCard card() {
    return {.id = "ruth_3",
            .title = "Ruth 3",
            .summary = "Ruth's symplectic scheme of order 3, three forces a step, not symmetric.",
            .orders = {{"", 3}},
            .structure = "symplectic",
            .good_for = "comparison; composed leapfrog of order 4 is usually the better choice",
            .fails_when = "ωh > 2.5; it cannot be composed, and it is not reversible",
            .needs = "a separable Hamiltonian: a potential and a constant kinetic metric",
            .references = {"Ruth, IEEE Transactions on Nuclear Science NS-30, 2669 (1983)"}};
  }
  template <Separable P, class X>
  auto bind(const P& problem, const X& x) const {
    return KickDrift<P, X>(problem, x, sequence<typename X::Time>());
  }
  template <class S>
  static const Sequence<S>& sequence() {
    static const Sequence<S> three{{S(0), S(7) / 24, S(2) / 3}, {S(0), S(3) / 4, -S(2) / 3}, {S(0), -S(1) / 24, S(1)}};
    return three;
  }
};

}  // namespace least
