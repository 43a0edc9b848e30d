// structure, volume, error: diagnostics made from whole states kept along the run, after it.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "core/number/linear.hpp"
#include "core/run/diagnostics/diagnostic.hpp"
#include "core/state_error.hpp"

namespace least {

/// Calls f(state, tangent of a step from it) at no more than 32 of the states before the end.
template <class P, class X, class F>
void for_each_tangent(const RunEnd<P, X>& end, F&& f) {
  const auto& states = end.states;
  for (std::size_t i = 0; i < states.size() && states[i].t < end.x.t; i += 1 + states.size() / 32)
    if (const auto tangent = end.tangent(states[i])) f(states[i], *tangent);
}

/// The largest defect of the form that the exact motion keeps over single steps that the run took: MᵀJM − J, or
/// φ*η − λη with λ of the first of them as `factor`. Null where there is no such step.
struct StructureRow {
  static constexpr DiagnosticCard info{"structure",
                                       "defect of the symplectic or the contact form over steps of the run"};
  static constexpr Sees sees = Sees::states;
  template <class P>
  static constexpr bool applies = Potential<P>;

  template <class P, class X>
  struct Seen {
    Report report(const RunEnd<P, X>& end) const {
      double most = unknown, factor = unknown;
      for_each_tangent(end, [&](const auto& x, const auto& tangent) {
        if constexpr (Contact<P>) {
          const auto [defect, lambda] = contact_defect(x, tangent);
          most = std::fmax(most, defect);
          if (std::isnan(factor)) factor = lambda;
        } else {
          most = std::fmax(most, symplectic_defect(tangent.m));
        }
      });
      Report report = numbers("structure", {{"max_defect", most}, {"factor", factor}});
      insert(report, 0, words("kind", end.scheme.structure));
      return report;
    }
  };
};

/// max_defect: of det DΦ = λⁿ⁺¹, which every contact map keeps. invariant_residual: of the volume H^−(n+1) η∧(dη)ⁿ,
/// which the exact autonomous flow keeps, that is of λH₀ = H₁; falls with the order. Over single steps the run took.
struct VolumeRow {
  static constexpr DiagnosticCard info{"volume", "defect of the contact volume over steps of the run", false, true};
  static constexpr Sees sees = Sees::states;
  template <class P>
  static constexpr bool applies = Contact<P>;

  template <class P, class X>
  struct Seen {
    Report report(const RunEnd<P, X>& end) const {
      double most = unknown, residual = unknown;
      constexpr int n = P::dof;
      for_each_tangent(end, [&](const auto& x, const auto& tangent) {
        const double factor = contact_defect(x, tangent).factor;
        most = std::fmax(most, std::abs(determinant(tangent.m) - std::pow(factor, n + 1)));
        const double before = energy(end.problem, x), after = energy(end.problem, tangent.image);
        residual = std::fmax(residual, std::abs(std::pow(factor * before / after, n + 1) - 1));
      });
      return numbers("volume", {{"max_defect", most}, {"invariant_residual", residual}});
    }
  };
};

/// Errors against the true motion, at the states kept (max) and at the final state. Null, with a warning, where that
/// could not be had.
struct ErrorRow {
  static constexpr DiagnosticCard info{"error", "against the closed form or a quad-precision run"};
  static constexpr Sees sees = Sees::states;
  template <class P>
  static constexpr bool applies = VectorField<P>;

  template <class P, class X>
  struct Seen {
    Report report(const RunEnd<P, X>& end) const {
      const std::size_t size = StateOf<P>::size;
      std::vector<FullStateOf<P>> states;
      for (const auto& x : end.states)
        if (x.t < end.x.t) states.push_back(x);
      assign(states.emplace_back(), plain(end.x));
      std::vector<double> times;
      for (const auto& x : states) times.push_back(x.t);
      Truth truth;
      truth.complete = true;
      const bool known = !end.states.empty();  // the run got as far as its start
      if (known) truth = end.scene.mechanics->truth(end.scene, times, end.keep_going);
      double most = unknown, last = unknown;
      if (!truth.complete)
        end.warnings.push_back(
            {"reference_not_finished", "the reference solution met the time limit, or is not finite"});
      if (known && truth.complete) {
        most = 0;
        for (std::size_t i = 0; i < times.size(); ++i) {
          last = state_error(states[i], truth.states[i], size);
          if (!(last <= most)) most = last;
        }
      }
      std::string how;
      if (known) how = std::string(truth.how) + (truth.complete ? "" : ", not finished");
      Report report = numbers(
          "error",
          {{"final", last}, {"max", most}, {"uncertainty", known && truth.complete ? truth.uncertainty : unknown}});
      insert(report, 2, words("reference", how));
      return report;
    }
  };
};

}  // namespace least
