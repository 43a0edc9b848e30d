// Steps of schemes that need only equations of motion, bound to the interface that a run has to every problem: compiled
// once for all problems.
#pragma once

#include <memory>

#include "core/run/integrator.hpp"
#include "core/run/taylor_stepper.hpp"
#include "core/schemes/odeint.hpp"

namespace least {

/// bind_taylor returns the scheme `taylor` from x with its own clock up to `end`. `expansion` is the series of the
/// states that the run carries; `completion` computes variables of the series that a state does not have.
std::unique_ptr<Integrator> bind_taylor(const RunBackend& problem, std::shared_ptr<taylor::Expansion> expansion,
                                        const RunState& x, double end,
                                        TaylorStepper::Completion completion = {nullptr, nullptr});
/// bind_odeint does the same for Odeint's schemes.
std::unique_ptr<Integrator> bind_odeint(const RunBackend& problem, const AnyOdeintScheme& scheme, const RunState& x,
                                        double end);

}  // namespace least
