// Steps of schemes that need equations of motion and nothing else, bound to what a run asks of any problem: compiled
// once, whatever the problem.
#pragma once

#include <memory>

#include "core/run/integrator.hpp"
#include "core/run/taylor_stepper.hpp"
#include "core/schemes/odeint.hpp"

namespace least {

/// `taylor` from x by its own clock up to `end`. `expansion`: the series of the states that the run carries;
/// `completion`: of variables of it that a state does not have.
std::unique_ptr<Integrator> bind_taylor(const RunBackend& problem, std::shared_ptr<taylor::Expansion> expansion,
                                        const RunState& x, double end,
                                        TaylorStepper::Completion completion = {nullptr, nullptr});
/// The same of Odeint's schemes.
std::unique_ptr<Integrator> bind_odeint(const RunBackend& problem, const AnyOdeintScheme& scheme, const RunState& x,
                                        double end);

}  // namespace least
