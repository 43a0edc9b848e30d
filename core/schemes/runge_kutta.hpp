// Explicit Runge–Kutta schemes, the controls without geometry: explicit_euler, explicit_midpoint, runge_kutta_4.
//   y₁ = y₀ + h Σ b_i k_i, k_i = f(t₀ + c_i h, y₀ + h a_i k_{i−1})
// Order 1, 2, 4; not symmetric; they keep no structure: energy drifts, and the phase volume with it. They need
// equations of motion and nothing else. explicit_euler and explicit_midpoint are unstable on every oscillation, at
// every step size; runge_kutta_4 beyond ωh = 2√2. Not to be confused: variational_midpoint is the implicit midpoint
// rule. Source: Hairer, Lubich, Wanner, Geometric Numerical Integration, 2006, II.1.
#pragma once

#include <tuple>

#include "core/scheme.hpp"

namespace least {

/// Stages whose increments depend on the one before alone, weighted at the end.
template <int Stages>
struct ExplicitTableau {
  double node[Stages], weight[Stages];
  double divisor;  ///< common to the weights, so that 1/6 and 1/3 are exact in every number
};

template <class P, class X, int Stages>
class ExplicitRungeKutta {
 public:
  ExplicitRungeKutta(const P& problem, const ExplicitTableau<Stages>& tableau) : problem_(problem), tableau_(tableau) {}

  StatusOf<typename X::Number> step(X& x, const typename X::Time& h) noexcept {
    X slope = derivative(problem_, x), sum = shifted(X{}, typename X::Time(tableau_.weight[0]), slope);
    for (int i = 1; i < Stages; ++i) {
      X y = shifted(x, h * tableau_.node[i], slope);
      y.t = x.t + h * tableau_.node[i];
      slope = derivative(problem_, y);
      sum = shifted(sum, typename X::Time(tableau_.weight[i]), slope);
    }
    x = shifted(x, h / tableau_.divisor, sum);
    work_.forces += Stages;
    return StepStatus::ok;
  }
  const Work& work() const { return work_; }
  /// The stepper keeps nothing of the state: a lane that moves to another stepper takes nothing along.
  template <class F>
  void each_kept(F&&) {}

 private:
  P problem_;
  ExplicitTableau<Stages> tableau_;
  Work work_;
};

struct ExplicitEuler {
  double step = 0.01;
  static constexpr bool of_rates_alone = true;
  static constexpr std::tuple fields{step_field<ExplicitEuler>()};
  static SchemeCard card() {
    return {.id = "explicit_euler",
            .title = "Explicit Euler",
            .summary = "The simplest scheme there is: one slope, followed for a step.",
            .orders = {{"", 1}},
            .structure = "none",
            .good_for = "showing what a scheme without geometry does: energy grows at every step",
            .fails_when = "anything oscillates, at every step size",
            .needs = "equations of motion",
            .references = {"Hairer, Lubich, Wanner 2006, I.1"}};
  }
  template <VectorField P, class X>
  auto bind(const P& problem, const X&) const {
    return ExplicitRungeKutta<P, X, 1>(problem, tableau);
  }
  static constexpr ExplicitTableau<1> tableau{{0}, {1}, 1};
};

struct ExplicitMidpoint {
  double step = 0.01;
  static constexpr bool of_rates_alone = true;
  static constexpr std::tuple fields{step_field<ExplicitMidpoint>()};
  static SchemeCard card() {
    return {.id = "explicit_midpoint",
            .title = "Explicit midpoint rule",
            .summary = "Runge's scheme of order 2: the slope at the middle of an Euler half-step.",
            .orders = {{"", 2}},
            .structure = "none",
            .good_for = "short runs; a control beside leapfrog, which costs half as much",
            .fails_when = "runs are long: energy grows like (ωh)³ per step, whatever the step",
            .needs = "equations of motion",
            .references = {"Hairer, Lubich, Wanner 2006, II.1 (1.5)"}};
  }
  template <VectorField P, class X>
  auto bind(const P& problem, const X&) const {
    return ExplicitRungeKutta<P, X, 2>(problem, tableau);
  }
  static constexpr ExplicitTableau<2> tableau{{0, 0.5}, {0, 1}, 1};
};

struct RungeKutta4 {
  double step = 0.01;
  static constexpr bool of_rates_alone = true;
  static constexpr std::tuple fields{step_field<RungeKutta4>()};
  static SchemeCard card() {
    return {.id = "runge_kutta_4",
            .title = "Runge–Kutta 4",
            .summary = "The classical scheme of order 4.",
            .orders = {{"", 4}},
            .structure = "none",
            .good_for = "short runs of any smooth system at moderate accuracy",
            .fails_when = "runs are long (energy drifts in one direction), or ωh > 2√2",
            .needs = "equations of motion",
            .references = {"Hairer, Lubich, Wanner 2006, II.1 (1.8)"}};
  }
  template <VectorField P, class X>
  auto bind(const P& problem, const X&) const {
    return ExplicitRungeKutta<P, X, 4>(problem, tableau);
  }
  static constexpr ExplicitTableau<4> tableau{{0, 0.5, 0.5, 1}, {1, 2, 2, 1}, 6};
};

}  // namespace least
