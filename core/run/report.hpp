// Diagnostics made from states kept along the run: structure and error.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "core/run/outcome.hpp"
#include "core/run/structure.hpp"
#include "core/study/reference.hpp"

namespace least {

/// The largest defect of MᵀJM − J over single steps that the run took, from at most 32 of the states before `end`; null
/// where there is none.
template <class P, class Scheme>
Report structure_report(const P& problem, const Scheme& scheme, const std::vector<StateOf<P>>& states, double end,
                        double h) {
  double most = std::nan("");
  for (std::size_t i = 0; i < states.size() && states[i].t < end; i += 1 + states.size() / 32)
    if (const auto m = tangent_map(scheme, problem, states[i], h)) most = std::fmax(most, symplectic_defect(*m));
  return {"structure",
          std::vector<Report>{
              {"kind", std::string(Scheme::card().structure)}, {"max_defect", most}, {"factor", std::monostate{}}}};
}

/// Errors against the reference solution, at the states kept (max) and at the final state. Null, with a warning, where
/// the reference could not be had.
template <class P, class KeepGoing>
Report error_report(const P& problem, const std::vector<StateOf<P>>& states, const StateOf<P>& final,
                    std::vector<Warning>& warnings, KeepGoing&& keep_going) {
  std::vector<double> times;
  for (const auto& x : states)
    if (x.t < final.t) times.push_back(x.t);
  times.push_back(final.t);
  Reference<P> reference;
  if (!states.empty()) reference = reference_solution(problem, states.front(), times, keep_going);
  double most = std::nan(""), last = std::nan("");
  if (!reference.complete)
    warnings.push_back({"reference_not_finished", "the reference solution met the time limit, or is not finite"});
  if (!states.empty() && reference.complete) {
    most = 0;
    for (std::size_t i = 0; i < times.size(); ++i) {
      last = state_error(i + 1 < times.size() ? states[i] : final, reference.states[i]);
      if (!(last <= most)) most = last;
    }
  }
  return {"error",
          std::vector<Report>{{"final", last},
                              {"max", most},
                              {"reference", std::string(reference.how) + (reference.complete ? "" : ", not finished")},
                              {"uncertainty", reference.complete ? reference.uncertainty : std::nan("")}}};
}

}  // namespace least
