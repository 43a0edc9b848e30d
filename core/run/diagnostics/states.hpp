// structure, volume: diagnostics made from whole states kept along the run, after it.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "core/number/linear.hpp"
#include "core/run/diagnostics/diagnostic.hpp"

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
/// which the exact autonomous flow keeps where H is not zero, that is of λH₀ = H₁; falls with the order. Over single
/// steps the run took. Where there is no such volume the residual is null, and `reason` says why.
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
      const std::string_view why = objection(end);
      for_each_tangent(end, [&](const auto& x, const auto& tangent) {
        const double factor = contact_defect(x, tangent).factor;
        most = std::fmax(most, std::abs(determinant(tangent.m) - std::pow(factor, n + 1)));
        if (!why.empty() || vanishes(end.problem, x)) return;
        const double before = energy(end.problem, x), after = energy(end.problem, tangent.image);
        residual = std::fmax(residual, std::abs(std::pow(factor * before / after, n + 1) - 1));
      });
      Report report = numbers("volume", {{"max_defect", most}, {"invariant_residual", residual}});
      const bool none = std::isnan(residual);
      insert(report, 2, words("reason", !none ? "" : !why.empty() ? why : "no step with derivatives was taken"));
      return report;
    }

   private:
    static std::string_view objection(const RunEnd<P, X>& end) {
      if constexpr (!Autonomous<P>) {
        return "H depends on time: the flow keeps no volume of this form";
      } else {
        const bool zero = !end.states.empty() && vanishes(end.problem, end.states.front());
        return zero ? "H is zero, and stays so: the volume is not defined there" : "";
      }
    }
    /// H is zero among its terms.
    template <class Y>
    static bool vanishes(const P& problem, const Y& x) {
      const auto f = phase(problem, x.t);
      double terms = 0.5 * dot(x.p, velocity(problem, x.q, x.p)) + std::abs(problem.potential(x.q, f));
      if constexpr (QuadraticContact<P>) terms += std::abs(problem.offset());
      terms += std::abs(action_slope(problem, x.action.s, f) * x.action.s);
      return !(std::abs(energy(problem, x)) > 1e-9 * terms);
    }
  };
};

}  // namespace least
