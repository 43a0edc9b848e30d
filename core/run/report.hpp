// Diagnostics made from states kept along the run: structure, volume and error.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "core/number/linear.hpp"
#include "core/run/outcome.hpp"
#include "core/run/structure.hpp"
#include "core/study/reference.hpp"

namespace least {

/// Calls f(state, tangent of a step from it) at no more than 32 of the states before `end`.
template <class X, class TangentAt, class F>
void for_each_tangent(TangentAt&& tangent_at, const std::vector<X>& states, double end, F&& f) {
  for (std::size_t i = 0; i < states.size() && states[i].t < end; i += 1 + states.size() / 32)
    if (const auto tangent = tangent_at(states[i])) f(states[i], *tangent);
}

/// The largest defect of the form that the exact motion keeps over single steps that the run took: MᵀJM − J, or
/// φ*η − λη with λ of the first of them as `factor`. Null where there is no such step.
template <class P, class TangentAt>
Report structure_report(TangentAt&& tangent_at, std::string_view kind, const std::vector<FullStateOf<P>>& states,
                        double end) {
  double most = unknown, factor = unknown;
  for_each_tangent(tangent_at, states, end, [&](const auto& x, const auto& tangent) {
    if constexpr (Contact<P>) {
      const auto [defect, lambda] = contact_defect(x, tangent);
      most = std::fmax(most, defect);
      if (std::isnan(factor)) factor = lambda;
    } else if constexpr (Potential<P>) {
      most = std::fmax(most, symplectic_defect(tangent.m));
    }
  });
  Report report = numbers("structure", {{"max_defect", most}, {"factor", factor}});
  insert(report, 0, words("kind", kind));
  return report;
}

/// max_defect: of det DΦ = λⁿ⁺¹, which every contact map keeps. invariant_residual: of the volume H^−(n+1) η∧(dη)ⁿ,
/// which the exact autonomous flow keeps, that is of λH₀ = H₁; falls with the order. Over single steps the run took.
template <class P, class TangentAt>
Report volume_report(TangentAt&& tangent_at, const P& problem, const std::vector<FullStateOf<P>>& states, double end) {
  double most = unknown, residual = unknown;
  if constexpr (Contact<P>) {
    constexpr int n = P::dof;
    for_each_tangent(tangent_at, states, end, [&](const auto& x, const auto& tangent) {
      const double factor = contact_defect(x, tangent).factor;
      most = std::fmax(most, std::abs(determinant(tangent.m) - std::pow(factor, n + 1)));
      const double before = energy(problem, x), after = energy(problem, tangent.image);
      residual = std::fmax(residual, std::abs(std::pow(factor * before / after, n + 1) - 1));
    });
  }
  return numbers("volume", {{"max_defect", most}, {"invariant_residual", residual}});
}

/// Errors against the reference solution, at the states kept (max) and at the final state. Null, with a warning, where
/// the reference could not be had.
template <class P, class KeepGoing>
Report error_report(const P& problem, const std::vector<FullStateOf<P>>& kept, const FullStateOf<P>& final,
                    std::vector<Warning>& warnings, KeepGoing&& keep_going) {
  std::vector<StateOf<P>> states;
  for (const auto& x : kept)
    if (x.t < final.t) assign(states.emplace_back(), x);
  assign(states.emplace_back(), final);
  std::vector<double> times;
  for (const auto& x : states) times.push_back(x.t);
  Reference<P> reference;
  if (!kept.empty()) reference = reference_solution(problem, states.front(), times, keep_going);
  double most = unknown, last = unknown;
  if (!reference.complete)
    warnings.push_back({"reference_not_finished", "the reference solution met the time limit, or is not finite"});
  if (!kept.empty() && reference.complete) {
    most = 0;
    for (std::size_t i = 0; i < times.size(); ++i) {
      last = state_error(states[i], reference.states[i]);
      if (!(last <= most)) most = last;
    }
  }
  std::string how;
  if (!kept.empty()) how = std::string(reference.how) + (reference.complete ? "" : ", not finished");
  const bool known = reference.complete && !kept.empty();
  Report report =
      numbers("error", {{"final", last}, {"max", most}, {"uncertainty", known ? reference.uncertainty : unknown}});
  insert(report, 2, words("reference", how));
  return report;
}

}  // namespace least
