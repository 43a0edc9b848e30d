// adaptive_verlet: leapfrog whose step follows a monitor U(q) of the position by a recursion in the density ρ of steps,
//   p½ = p − (h/2ρ)∇V(q), q½ = q + (h/2ρ)g⁻¹p½;  ρ₁ = 2U(q½) − ρ;
//   q₁ = q½ + (h/2ρ₁)g⁻¹p½, p₁ = p½ − (h/2ρ₁)∇V(q₁);  t += (h/2)(1/ρ + 1/ρ₁)
// with ρ = U(q) at the start and U scaled to 1 there, so that h is the length in time of a step at the start. Explicit,
// one force and one look at the monitor a step, order 2. Reversible: (q, −p, ρ) at the end of a run leads back; not
// symplectic. Angular momentum is kept. ρ is state: a step depends on where the run began. Monitors:
//   arclength  √(1 + 2(E₀ − V)/ε): steps of equal length of the graph (t, q(t)), E₀ being the level of the run's start
//              and ε the energy that makes lengths of times
//   frequency  the largest local frequency, or √|g⁻¹V″|, Frobenius' norm, where the problem has no estimate; where it
//              is 0 at the start, as in a uniform field, there is nothing to follow, and steps are of equal length
// It needs a potential that does not depend on time, and assumes that U varies little within a step: ρ − U alternates
// in sign and does not decay; |ρ₁ − ρ| > U/2 is singular. Look-alike: a step chosen from the state before each step is
// not reversible. Source: Huang & Leimkuhler, SIAM J. Sci. Comput. 18, 239 (1997); Leimkuhler & Reich, Simulating
// Hamiltonian Dynamics, 2004, 9.3.
#pragma once

#include <limits>
#include <tuple>

#include "core/scheme.hpp"

namespace least {

enum class Monitor : std::uint8_t { arclength, frequency };
inline constexpr std::array<std::string_view, 2> monitor_names{"arclength", "frequency"};

/// The square of the largest local frequency at q: the problem's estimate, or Frobenius' norm of g⁻¹V″ where the metric
/// is constant.
template <Separable P, class T>
T local_frequency_squared(const P& m, const Vec<P::dof, T>& q) {
  if constexpr (HasFrequency<P>) {
    return m.frequency_squared(q);
  } else {
    using least::sqrt;
    const auto slope = gradient(m, seed<P::dof, T>(q));
    T sum(0);
    for (std::size_t k = 0; k < slope.size(); ++k) {
      Vec<P::dof, T> column;
      for (std::size_t i = 0; i < column.size(); ++i) column[i] = slope[i].slope[k];
      column = velocity(m, q, column);
      sum = sum + dot(column, column);
    }
    return sqrt(sum);
  }
}

template <Separable P, class X>
class AdaptiveVerletStepper {
 public:
  using T = typename X::Number;

  AdaptiveVerletStepper(const P& problem, const X& x, const T& energy, double step, Monitor monitor, double unit)
      : problem_(problem),
        monitor_(monitor),
        energy_(energy),
        per_unit_(2 / unit),
        half_(T(0.5 * step)),
        slope_(gradient(problem, x.q)) {
    using least::select;
    const T start = this->monitor(x.q);
    scale_ = select(start <= T(0), T(-1), 1.0 / start);
    ++work_.forces;
  }

  StepStatus step(X& x) noexcept {
    using least::all;
    X y = x;
    T dt = half_ / density_;
    kick(y, dt, slope_);
    drift(y, dt);
    using least::select;
    const T rate = select(scale_ < T(0), T(1), scale_ * monitor(y.q));
    const T density = 2.0 * rate - density_, after = half_ / density;
    drift(y, after);
    const auto slope = gradient(problem_, y.q);
    work_.forces += 2;  // the monitor looked at q½
    kick(y, after, slope);
    dt = dt + after;
    // Where the density swings by more than half of U about it, the recursion follows nothing any more.
    if (!all((5.0 * density >= 3.0 * density_) & (3.0 * density <= 5.0 * density_))) return StepStatus::singular;
    y.t = x.t + dt;
    x = y;
    density_ = density;
    slope_ = slope;
    return StepStatus::ok;
  }
  const Work& work() const { return work_; }
  /// ρ, 1 at the start.
  const T& density() const { return density_; }

 private:
  T monitor(const Vec<P::dof, T>& q) const {
    using least::sqrt;
    return sqrt(monitor_ == Monitor::arclength ? 1.0 + per_unit_ * (energy_ - potential(problem_, q))
                                               : local_frequency_squared(problem_, q));
  }
  static void kick(X& x, const T& h, const Vec<P::dof, T>& slope) {
    for (std::size_t i = 0; i < x.p.size(); ++i) x.p[i] = x.p[i] - h * slope[i];
  }
  void drift(X& x, const T& h) const {
    const auto v = velocity(problem_, x.q, x.p);
    for (std::size_t i = 0; i < x.q.size(); ++i) x.q[i] = x.q[i] + h * v[i];
  }

  P problem_;
  Monitor monitor_;
  T energy_;                   ///< E₀
  double per_unit_;            ///< 2/ε
  T half_;                     ///< h/2
  T scale_{}, density_ = 1.0;  ///< 1/U(q₀) unscaled, or −1 where U(q₀) is 0; ρ
  Vec<P::dof, T> slope_;       ///< ∇V at the state's q
  Work work_;
};

struct AdaptiveVerlet {
  double step = 0.01;
  Monitor monitor = Monitor::frequency;
  double unit_energy = 1;

  static constexpr bool own_clock = true, remembers = true;
  static constexpr std::tuple fields{
      step_field<AdaptiveVerlet>(),
      Field<AdaptiveVerlet, Monitor>{"monitor",
                                     "",
                                     "",
                                     "what steps are inverse to: the length of the graph of the motion, or the local "
                                     "frequency",
                                     &AdaptiveVerlet::monitor,
                                     {0, 0},
                                     monitor_names},
      Field<AdaptiveVerlet>{"unit_energy",
                            "ε",
                            "energy",
                            "of the graph's length: a kinetic energy far above this makes steps of equal length, one "
                            "far below steps of equal time",
                            &AdaptiveVerlet::unit_energy,
                            any_strength,
                            {},
                            "unit_energy"},
  };
  static SchemeCard card() {
    return {.id = "adaptive_verlet",
            .title = "Adaptive Verlet",
            .summary =
                "Leapfrog with steps that follow the motion by a symmetric recursion: reversible, not symplectic. "
                "`step` is "
                "the length in time of a step at the start of the run.",
            .orders = {{"", 2}},
            .symmetric = true,
            .structure = "none",
            .keeps_momenta = true,
            .good_for = "eccentric orbits of any potential at moderate accuracy, explicit",
            .fails_when =
                "the step changes much from one step to the next (ρ oscillates, then it stops as singular), or digits "
                "count: it cannot be composed",
            .needs = "a separable Hamiltonian: a potential that does not depend on time and a constant kinetic metric",
            .references = {"Huang, Leimkuhler, SIAM Journal on Scientific Computing 18, 239 (1997)",
                           "Leimkuhler, Reich, Simulating Hamiltonian Dynamics, 2004, 9.3"}};
  }
  template <Separable P, class X>
  requires Autonomous<P>
  auto bind(const P& problem, const X& x, const typename X::Number& energy) const {
    return AdaptiveVerletStepper<P, X>(problem, x, energy, step, monitor, unit_energy);
  }
};

}  // namespace least
