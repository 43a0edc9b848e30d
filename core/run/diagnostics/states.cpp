// structure, volume: diagnostics made after a run from states kept along it.

#include <cmath>
#include <string>
#include <utility>

#include "core/run/diagnostics/rows.hpp"

namespace least {
namespace {

/// for_each_map calls f with the tangent maps of steps from at most 32 of the states before the end, as many as there
/// is time for; on the extended space if the scheme's steps are contact maps there.
template <class F>
void for_each_map(const RunEnd& end, const KeepGoing& keep_going, F&& f) {
  const auto& states = end.states;
  const StepTangents tangents = end.backend.tangents(end.request);
  TangentMap map;
  for (std::size_t i = 0; i < states.size() && states[i].t < end.x.t; i += 1 + states.size() / 32) {
    if (tangents.plain && tangents.plain(states[i], keep_going, map)) f(map);
    if (tangents.extended && tangents.extended(states[i], keep_going, map)) f(map);
  }
}

/// Structure reports the largest defect, over single steps of the run, of the form that the exact motion conserves:
/// MᵀJM − J, or if the motion depends on s, φ*η − λη with λ of the first step as `factor`. Null if there is no such
/// step. `kind` is the form that the scheme conserves on this scene.
class Structure final : public Diagnostic {
 public:
  explicit Structure(KeepGoing keep_going) : keep_going_(std::move(keep_going)) {}

  Report report(const RunEnd& end) override {
    const bool acts = end.problem.reads_action();
    double most = unknown, factor = unknown;
    for_each_map(end, keep_going_, [&](const TangentMap& map) {
      if (!acts) {  // if there is an s, it is constant and has no effect
        most = std::fmax(most, symplectic_defect(map));
        return;
      }
      const auto [defect, lambda] = contact_defect(map);
      most = std::fmax(most, defect);
      if (std::isnan(factor)) factor = lambda;
    });
    Report report = numbers("structure", {{"max_defect", most}, {"factor", factor}});
    const std::string_view scheme = end.scheme.structure;  // a volume alone is not a form
    const std::string_view own = end.problem.traits.forced || scheme == "volume" ? "none" : scheme;
    const bool kept = own != "none", general = end.problem.traits.general;
    insert(report, 0, words("kind", kept && acts ? "contact" : kept && general ? "symplectic" : own));
    return report;
  }

 private:
  KeepGoing keep_going_;
};

/// Volume reports defects over single steps of the run. max_defect: of det DΦ = λⁿ⁺¹ (λⁿ⁺² on the extended space),
/// which every contact map conserves. invariant_residual: of the volume H^−(n+1) η∧(dη)ⁿ, which the exact autonomous
/// flow conserves where H is not zero, that is of λH₀ = H₁; it falls with the order of the scheme. If there is no such
/// volume the residual is null, and `reason` says why.
class Volume final : public Diagnostic {
 public:
  explicit Volume(KeepGoing keep_going) : keep_going_(std::move(keep_going)) {}

  Report report(const RunEnd& end) override {
    double most = unknown, residual = unknown;
    const std::string_view why = objection(end);
    for_each_map(end, keep_going_, [&](const TangentMap& map) {
      const auto n = static_cast<int>(map.dof), dof = static_cast<int>(end.problem.traits.dof);
      const double factor = contact_defect(map).factor;
      most = std::fmax(most, std::abs(determinant(map) - std::pow(factor, n + 1)));
      const RunState from = state_at(map, map.from), to = state_at(map, map.to);
      if (!why.empty() || vanishes(end.problem, from)) return;
      residual = std::fmax(residual,
                           std::abs(std::pow(factor * end.problem.energy(from) / end.problem.energy(to), dof + 1) - 1));
    });
    Report report = numbers("volume", {{"max_defect", most}, {"invariant_residual", residual}});
    const bool none = std::isnan(residual);
    insert(report, 2, words("reason", !none ? "" : !why.empty() ? why : "no step with derivatives was taken"));
    return report;
  }

 private:
  /// state_at returns the state of a point of the map's space, which may be the extended space.
  static RunState state_at(const TangentMap& map, const RunState& z) {
    if (!map.extended) return z;
    const std::size_t n = map.dof - 1;
    RunState x{z[n], StateNumbers(2 * n + 1)};
    for (std::size_t i = 0; i < n; ++i) {
      x[i] = z[i];
      x[n + i] = z[n + 1 + i];
    }
    x[2 * n] = z[2 * n + 2];
    return x;
  }
  static std::string_view objection(const RunEnd& end) {
    if (!end.problem.traits.autonomous) return "H depends on time: the flow keeps no volume of this form";
    const bool zero = !end.states.empty() && vanishes(end.problem, end.states.front());
    return zero ? "H is zero, and stays so: the volume is not defined there" : "";
  }
  /// vanishes returns whether H is zero relative to its terms.
  static bool vanishes(const ProblemTable& problem, const RunState& x) {
    const EnergyTerms energy = problem.energy_terms(x);
    const double terms = energy.kinetic + std::abs(energy.potential) + std::abs(problem.offset()) +
                         std::abs(energy.action_slope * x[2 * problem.traits.dof]);
    return !(std::abs(energy.total) > 1e-9 * terms);
  }

  KeepGoing keep_going_;
};

}  // namespace

std::unique_ptr<Diagnostic> structure_diagnostic(const RunBackend&, const Request&, const KeepGoing& keep_going) {
  return std::make_unique<Structure>(keep_going);
}
std::unique_ptr<Diagnostic> volume_diagnostic(const RunBackend&, const Request&, const KeepGoing& keep_going) {
  return std::make_unique<Volume>(keep_going);
}

}  // namespace least
