#include "core/catalogue/equation_steps.hpp"

#include "core/run/control_stepper.hpp"
#include "core/run/self_timed.hpp"

namespace least {
namespace {

/// Equations is a problem in the form that these schemes need.
struct Equations {
  const RunBackend* of;
};

struct BySeries {
  std::shared_ptr<taylor::Expansion> expansion;
  TaylorStepper::Completion completion;

  static constexpr bool own_clock = true, asks_no_level = true;
  TaylorStepper bind(const Equations&, const RunState&, double) const { return TaylorStepper(expansion, completion); }
};

struct ByOdeint {
  AnyOdeintScheme chosen;

  static constexpr bool own_clock = true, reads_time = true, asks_no_level = true;
  ControlStepper bind(const Equations& equations, const RunState&, double) const {
    return {*equations.of, chosen.tolerance, chosen.method, true};
  }
};

template <class Scheme>
std::unique_ptr<Integrator> bind(const RunBackend& problem, const Scheme& scheme, const RunState& x, double end) {
  return std::make_unique<SelfTimedIntegrator<Equations, Scheme, RunState>>(problem, Equations{&problem}, scheme, x,
                                                                            end);
}

}  // namespace

std::unique_ptr<Integrator> bind_taylor(const RunBackend& problem, std::shared_ptr<taylor::Expansion> expansion,
                                        const RunState& x, double end, TaylorStepper::Completion completion) {
  return bind(problem, BySeries{std::move(expansion), completion}, x, end);
}
std::unique_ptr<Integrator> bind_odeint(const RunBackend& problem, const AnyOdeintScheme& scheme, const RunState& x,
                                        double end) {
  return bind(problem, ByOdeint{scheme}, x, end);
}

}  // namespace least
