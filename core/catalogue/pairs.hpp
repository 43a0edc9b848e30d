// The pairs of a problem with the schemes that fit, as integrators; compiled with every optimisation.
#pragma once

#include <memory>

#include "core/catalogue/compiled.hpp"
#include "core/run/fixed_step.hpp"
#include "core/run/self_timed.hpp"

namespace least {

/// compiled_scheme returns one type for schemes whose compiled code does not differ.
template <class Scheme>
auto compiled_scheme(const Scheme& scheme) {
  if constexpr (requires { scheme.compiled_as(); }) {
    return scheme.compiled_as();
  } else {
    return scheme;
  }
}

template <class P, class X>
std::unique_ptr<Integrator> bind_scheme(const RunBackend& backend, const P& problem, const Request& request,
                                        const RunState& x, const Grid& grid, double end) {
  std::unique_ptr<Integrator> bound;
  with_scheme<P>(request, [&]<class Scheme>(const Scheme& chosen) {
    if constexpr (!OnEquations<Scheme>) {
      const auto scheme = compiled_scheme(chosen);
      using Compiled = std::remove_const_t<decltype(scheme)>;
      if constexpr (SelfTimed<Compiled>) {
        bound = std::make_unique<SelfTimedIntegrator<P, Compiled, X>>(backend, problem, scheme, state_from<X>(x), end);
      } else {
        bound = std::make_unique<FixedStepIntegrator<P, Compiled, X>>(backend.table(), problem, scheme, x, grid);
      }
    }
  });
  return bound;
}

/// Instantiates bind_scheme for each type of state that a run can carry.
template <class P>
struct Pairs {
  static constexpr auto motion = &bind_scheme<P, StateOf<P>>;
  static constexpr auto full = &bind_scheme<P, FullRunState<P>>;
};

}  // namespace least
