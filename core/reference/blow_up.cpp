#include "core/reference/blow_up.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/reference/true_motion.hpp"

namespace least {
namespace {

/// Returns the time at which s would become infinite if K − V stayed as it is at x: by ṡ = c − γs²/2 with c = K − V +
/// R. Returns `unknown` if s would not.
double blow_up_time(const ProblemTable& problem, const RunState& x) {
  const EnergyTerms energy = problem.energy_terms(x);
  const double s = x[2 * problem.traits.dof], gamma = problem.action_curvature();
  const double c = energy.kinetic - energy.potential + problem.offset();
  const double w = std::sqrt(std::abs(gamma * c) / 2), slope = gamma * s / 2;
  double wait = unknown;  // the first zero of cosh wh + (slope/w) sinh wh
  if (gamma * c > 0 && -slope > w) wait = std::atanh(-w / slope) / w;
  if (gamma * c == 0 && slope < 0) wait = -1 / slope;
  if (gamma * c < 0) wait = std::atan2(w, -slope) / w;
  return x.t + wait;
}

}  // namespace

double true_blow_up_time(const RunBackend& backend, const RunState& x0, double latest, double stride,
                         const KeepGoing& keep_going) {
  tape::Tape tape;
  const auto rates = backend.write_equations(tape);
  if (!TrueMotion::covers(tape)) return unknown;
  TrueMotion truth(std::move(tape), rates, 1e-20);
  truth.start(std::vector<DoubleDouble>(x0.numbers.begin(), x0.numbers.end()), x0.t);
  for (RunState x = x0; x.t <= latest;) {
    const double when = blow_up_time(backend.motion(), x), wait = when - x.t;
    if (wait < 1e-13 * std::max(std::abs(when), when - x0.t)) return when;
    x.t += wait > 0 ? std::min(stride, 0.8 * wait) : stride;
    const auto reached = truth.at(x.t, keep_going);
    if (reached.empty()) break;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = reached[i].high();
  }
  return unknown;
}

}  // namespace least
