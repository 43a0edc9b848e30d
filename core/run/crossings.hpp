// What vanishes within a step, located by the dense output of the integrator that took it.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "core/run/diagnostics/watch.hpp"
#include "core/run/integrator.hpp"

namespace least {

/// The zeros of the scene's sections within the last step, which ended in the state.
template <class P, class X>
void locate_sections(const P& problem, const Integrator<P, X>& integrator, const IntegrationState<X>& state,
                     Events& events) {
  const auto at = [&](double t) {
    X x = state.x;
    integrator.state_at(state, t, x);
    return x;
  };
  X from = integrator.left();
  const double start = from.t, parts = integrator.parts();
  for (double part = 1; part <= parts; ++part) {
    const X to = part < parts ? at(start + part * (state.x.t - start) / parts) : state.x;
    events.locate(problem, from, to, at);
    from = to;
  }
}

/// Shows the diagnostics what lies within the last step up to this time, and nothing beyond; or within the next one.
template <class P, class X>
void look_within(const P& problem, const Integrator<P, X>& integrator, const IntegrationState<X>& state, double until,
                 DiagnosticSet<P, X>& diagnostics) {
  if (!diagnostics.looks_within()) return;
  diagnostics.look_again();
  const double from = until > state.x.t ? state.x.t : integrator.left().t, parts = integrator.parts();
  for (double part = 1; part < parts; ++part) {
    X x = state.x;
    if (integrator.state_at(state, from + part * (until - from) / parts, x) == StepStatus::ok)
      diagnostics.look(problem, x);
  }
}

/// With how many pieces of a step a search begins whose steps are looked at in so many parts: a piece shows four.
inline int pieces_of(int parts) { return std::max(parts / 4, 1); }

/// The zeros of what the caller watches, with the states there, between two states of the last step or of the next one:
/// in their order, up to the first that ends the run.
template <class P, class X>
std::vector<std::pair<Zero, X>> watched_zeros(const P& problem, const Integrator<P, X>& integrator,
                                              const IntegrationState<X>& state, Watch& watch, const X& from,
                                              const X& to) {
  if (watch.empty()) return {};
  const Measures& measures = watch.measures();
  const auto at = [&](double t, X& x) {
    x = state.x;
    return integrator.state_at(state, t, x) == StepStatus::ok && !outside(problem, x);
  };
  const auto observe_at = [&](double t, double* observed) {
    X x;
    if (!at(t, x)) return false;
    std::copy_n(observe(problem, x, measures).begin(), measures.reads.size(), observed);
    return true;
  };
  std::vector<std::pair<Zero, X>> found;
  for (const Zero& zero :
       watch.locate(observe(problem, from, measures).data(), from.t, observe(problem, to, measures).data(), to.t,
                    observe_at, pieces_of(integrator.parts()))) {
    X x = zero.t > from.t ? to : from;
    if (zero.t > from.t && zero.t < to.t) at(zero.t, x);
    found.emplace_back(zero, x);
  }
  return found;
}

/// What the caller watches and the run reaches from above exactly where it ends: see Watch::reached.
template <class P, class X>
std::vector<std::size_t> reached_at_end(const P& problem, const Integrator<P, X>& integrator,
                                        const IntegrationState<X>& state, const Watch& watch) {
  if (watch.empty()) return {};
  const X& end = state.x;
  X before = integrator.left();
  // Shortly before: further back the expression may have turned.
  if (const double last = end.t - 0x1p-20 * (end.t - before.t); last < end.t) integrator.state_at(state, last, before);
  const Measures& measures = watch.measures();
  return watch.reached(observe(problem, before, measures).data(), before.t, observe(problem, end, measures).data(),
                       end.t);
}

}  // namespace least
