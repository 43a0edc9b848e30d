// regular_state gives the state of the regular motion from a singular start at a later time.
#pragma once

#include <algorithm>
#include <string>

#include "core/reference/reference.hpp"
#include "core/run/messages.hpp"

namespace least {

/// Returns the state at t ≠ 0, rounded to double: by the series of the problem as far as it reaches, from there on by
/// the reference integrator; or a message that says why the state is not known.
template <HasSeries P>
RegularStart regular_state(const P& problem, double t) {
  using X = FullStateOf<P>;
  const auto listed = [](const X& x) {
    std::vector<double> variables;
    for (std::size_t i = 0; i < X::size; ++i) variables.push_back(x[i]);
    return variables;
  };
  if (t < 0) return {{}, "the regular motion begins at t = 0; before that the state must be given"};
  if (t <= P::series_until) return {listed(series_state<X>(problem, t)), {}};  // the bits by which it is recognised
  using Y = FullStateOf<P, Quad, Quad>;
  Extrapolation<P, Y> motion(problem, series_state<Y>(problem, Quad(0)), 1e-27);
  int patience = 2000;  // in attempts at a step, so that the answer does not depend on the machine
  while (motion.state().t < Quad(t)) {
    const Quad ahead = motion.state().t * Quad(1.1) + Quad(0.1);
    if (!motion.advance(std::min(ahead, Quad(t)), [&] { return --patience > 0; })) break;
    if constexpr (HasDomain<P>)
      if (problem.bounded() && problem.inside(position(convert<double, double>(motion.state()))) < 0)
        return {{},
                "the regular motion from t = 0 leaves its domain before t = " +
                    messages::number(static_cast<double>(motion.state().t)) + "; later the state must be given"};
  }
  const X x = convert<double, double>(motion.state());
  if (x.t == t && std::isfinite(state_error(x, X{}))) return {listed(x), {}};
  return {{}, "the regular motion from t = 0 is not known at this time, or not finite; the state must be given"};
}

}  // namespace least
