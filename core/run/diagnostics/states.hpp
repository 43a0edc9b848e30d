// structure, volume: diagnostics made from whole states kept along the run, after it.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "core/number/linear.hpp"
#include "core/run/diagnostics/diagnostic.hpp"

namespace least {

/// Calls f(state, tangent of a step from it) at no more than 32 of the states before the end; both are of the extended
/// space where it is there that the scheme's steps are contact maps.
template <class P, class X, class F>
void for_each_tangent(const RunEnd<P, X>& end, F&& f) {
  const auto& states = end.states;
  for (std::size_t i = 0; i < states.size() && states[i].t < end.x.t; i += 1 + states.size() / 32) {
    if (const auto tangent = end.tangent(states[i])) f(states[i], *tangent);
    if constexpr (LinearContact<P>)
      if (const auto step = end.extended_tangent(states[i])) f(step->start, step->tangent);
  }
}
/// The state at a state, or at a point of the extended space.
template <class P, class Z>
FullStateOf<P> state_at(const P&, const Z& z) {
  if constexpr (Z::dof == P::dof) {
    return z;
  } else {
    FullStateOf<P> x;
    x.t = z.q[P::dof];
    for (std::size_t i = 0; i < P::dof; ++i) {
      x.q[i] = z.q[i];
      x.p[i] = z.p[i];
    }
    x.action = z.action;
    return x;
  }
}

/// The form that the exact motion keeps is the contact form; else it is the symplectic one.
template <class P>
inline constexpr bool has_contact_form = Contact<P> || GeneralHamiltonian<P>;
template <class P>
bool acts([[maybe_unused]] const P& problem) {
  if constexpr (GeneralHamiltonian<P>) return problem.reads_action();
  return has_contact_form<P>;
}

/// The largest defect of the form that the exact motion keeps over single steps that the run took: MᵀJM − J, or
/// φ*η − λη with λ of the first of them as `factor`. Null where there is no such step. A scheme that keeps the form of
/// a scene keeps that which the scene has.
struct StructureRow {
  static constexpr DiagnosticCard info{"structure",
                                       "defect of the symplectic or the contact form over steps of the run"};
  static constexpr Sees sees = Sees::states;
  template <class P>
  static constexpr bool applies = Potential<P> || GeneralHamiltonian<P>;

  template <class P, class X>
  struct Seen {
    Report report(const RunEnd<P, X>& end) const {
      double most = unknown, factor = unknown;
      for_each_tangent(end, [&](const auto& x, const auto& tangent) {
        if constexpr (GeneralHamiltonian<P>) {
          if (!end.problem.reads_action()) {  // s rests, and takes no part
            constexpr int both = 2 * P::dof;
            Mat<both> block;
            for (std::size_t a = 0; a < both; ++a)
              for (std::size_t b = 0; b < both; ++b) block[a][b] = tangent.m[a][b];
            most = std::fmax(most, symplectic_defect(block));
            return;
          }
        }
        if constexpr (has_contact_form<P>) {
          const auto [defect, lambda] = contact_defect(x, tangent);
          most = std::fmax(most, defect);
          if (std::isnan(factor)) factor = lambda;
        } else {
          most = std::fmax(most, symplectic_defect(tangent.m));
        }
      });
      Report report = numbers("structure", {{"max_defect", most}, {"factor", factor}});
      const bool kept = end.scheme.structure != "none", general = GeneralHamiltonian<P>;
      insert(report, 0,
             words("kind", kept && acts(end.problem) ? "contact"
                           : kept && general         ? "symplectic"
                                                     : end.scheme.structure));
      return report;
    }
  };
};

/// max_defect: of det DΦ = λⁿ⁺¹ (λⁿ⁺² on the extended space), which every contact map keeps. invariant_residual: of the
/// volume H^−(n+1) η∧(dη)ⁿ, which the exact autonomous flow keeps where H is not zero, that is of λH₀ = H₁; falls with
/// the order. Over single steps the run took. Where there is no such volume the residual is null, and `reason` says
/// why.
struct VolumeRow {
  static constexpr DiagnosticCard info{"volume", "defect of the contact volume over steps of the run", false, true};
  static constexpr Sees sees = Sees::states;
  template <class P>
  static constexpr bool applies = Contact<P>;

  template <class P, class X>
  struct Seen {
    Report report(const RunEnd<P, X>& end) const {
      double most = unknown, residual = unknown;
      const std::string_view why = objection(end);
      for_each_tangent(end, [&](const auto& x, const auto& tangent) {
        constexpr int n = std::remove_cvref_t<decltype(x)>::dof;
        const double factor = contact_defect(x, tangent).factor;
        most = std::fmax(most, std::abs(determinant(tangent.m) - std::pow(factor, n + 1)));
        const auto from = state_at(end.problem, x), to = state_at(end.problem, tangent.image);
        if (!why.empty() || vanishes(end.problem, from)) return;
        residual = std::fmax(
            residual, std::abs(std::pow(factor * energy(end.problem, from) / energy(end.problem, to), P::dof + 1) - 1));
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
