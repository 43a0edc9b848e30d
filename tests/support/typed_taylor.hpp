// `taylor` on states of a problem's own type, for tests that are templates on the scheme and the state.
#pragma once

#include "core/run/taylor_stepper.hpp"
#include "core/schemes/taylor.hpp"

namespace least {

template <class P, class X>
class TypedTaylorStepper {
 public:
  TypedTaylorStepper(const P& problem, double tolerance, int order)
      : stepper_(taylor::expansion_of<X>(problem, tolerance, order)) {}

  StepStatus step(X& x) noexcept {
    return moved(x, [this](RunState& y) { return stepper_.step(y); });
  }
  StepStatus reach(X& x, double t) noexcept {
    return moved(x, [this, t](RunState& y) { return stepper_.reach(y, t); });
  }
  bool interpolate(X& x, double t) const {
    RunState y = run_state(x);
    if (!stepper_.interpolate(y, t)) return false;
    x = state_from<X>(y);
    return true;
  }
  const Work& work() const { return stepper_.work(); }

 private:
  template <class Move>
  static StepStatus moved(X& x, Move&& move) {
    RunState y = run_state(x);
    const StepStatus status = move(y);
    if (status == StepStatus::ok) x = state_from<X>(y);
    return status;
  }

  TaylorStepper stepper_;
};

struct TypedTaylor {
  double tolerance = 1e-12;
  int order = 0;

  static constexpr bool own_clock = true, asks_no_level = true;
  static SchemeCard card() { return Taylor::card(); }
  template <VectorField P, class X>
  auto bind(const P& problem, const X&, const typename X::Number& = {}) const {
    return TypedTaylorStepper<P, X>(problem, tolerance, order);
  }
};

}  // namespace least
