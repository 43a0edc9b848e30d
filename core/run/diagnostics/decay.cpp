// decay: the law of decay of a contact Hamiltonian, Ḣ = −H H_s + H_t, along the states of a run. With the integrals A =
// ∫H_s dt and G = ∫H_t eᴬ dt the exact motion conserves H eᴬ − G. So in a step from x to y, if the exact flow leads
// from x to z instead, the conserved quantity H eᴬ − G changes by eᴬ (H(y) − H(z)): only the motion itself has to be
// integrated, to round-off. With constant damping and without a drive, G = 0 and A = αt. Source: Bravetti, Cruz,
// Tapias, Ann. Phys. 376, 17 (2017), eq. 22.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/run/backend.hpp"
#include "core/run/diagnostics/rows.hpp"

namespace least {
namespace {

class Decay final : public Diagnostic {
 public:
  explicit Decay(const RunBackend& backend) : backend_(backend) {}

  void start(const ProblemTable& problem, StateView x) override {
    const EnergyTerms terms = problem.energy_terms(x);
    initial_ = terms.total;
    closed_ = problem.traits.constant_damping && problem.traits.autonomous;
    if (problem.traits.constant_damping) damping_ = problem.damping(x.t);
    keep(problem, x);
    initial_terms_ = see_rounding(problem, x, terms, 1);
  }

  void see(const ProblemTable& problem, StateView x) override { see(problem, x, problem.energy_terms(x)); }
  void see(const ProblemTable& problem, const StateRows& states) override {
    std::array<EnergyTerms, 64> terms;  // number of states whose energies are computed at once
    for (std::size_t from = 0; from < states.count; from += terms.size()) {
      const StateRows part = states.part(from, terms.size());
      problem.energy_terms(part, terms.data());
      for (std::size_t i = 0; i < part.count; ++i) see(problem, part[i], terms[i]);
    }
  }

  /// max_residual: the largest change of H eᴬ − G; floor: the part of it that rounding explains. Both relative to |H|
  /// at the start, absolute if H starts at zero.
  Report report(const RunEnd&) override {
    const double scale = std::abs(initial_) > 1e-9 * initial_terms_ ? std::abs(initial_) : 1;
    return numbers("decay", {{"max_residual", residual_ / scale}, {"floor", floor() / scale}});
  }

 private:
  void see(const ProblemTable& problem, StateView x, const EnergyTerms& terms) {
    if (std::isnan(residual_))
      return;  // nothing can change that, and a flow that cannot be followed is expensive to try
    exponent_ += damping_between(problem, before_, x);
    const double grown = std::exp(exponent_);
    if (closed_) {
      change_ = terms.total * grown - initial_;
    } else {
      change_ += grown * (terms.total - backend_.energy_after(before_, x.t));
    }
    const double wrong = std::abs(change_);
    if (!(wrong <= residual_)) residual_ = wrong;  // NaN stays
    see_rounding(problem, x, terms, grown);
    keep(problem, x);
  }
  void keep(const ProblemTable& problem, StateView x) {
    before_.t = x.t;
    if (!closed_) before_.numbers.assign(x.numbers, x.numbers + problem.traits.numbers);
  }
  /// ∫H_s dt: exact for constant damping; otherwise by Simpson's rule, which suffices, since it only weighs the errors
  /// of steps.
  double damping_between(const ProblemTable& problem, StateView a, StateView b) const {
    const double h = b.t - a.t;
    if (problem.traits.constant_damping) return h * damping_;
    const std::size_t action = 2 * problem.traits.dof;
    const double middle = problem.action_slope((a[action] + b[action]) / 2, a.t + h / 2);
    return h / 6 * (problem.action_slope(a[action], a.t) + 4 * middle + problem.action_slope(b[action], b.t));
  }

  /// Each step rounds its state by a unit of the terms of H, at worst always in the same direction (the weights of a
  /// composition do: 1.5e-12 after 2,000 steps of order 10), and evaluating the law costs a few units more. Returns the
  /// sum of the terms. `grown`: eᴬ.
  double see_rounding(const ProblemTable& problem, StateView x, const EnergyTerms& energy, double grown) {
    const double terms =
        energy.kinetic + std::abs(energy.potential) + std::abs(energy.action_slope * x[2 * problem.traits.dof]);
    const double unit = std::numeric_limits<double>::epsilon() * grown * terms;
    of_steps_ += unit;
    of_reading_ = std::max(of_reading_, 4 * unit);
    return terms;
  }
  double floor() const { return of_steps_ + of_reading_; }

  const RunBackend& backend_;
  bool closed_ = false;  ///< whether the law has a closed form
  double damping_ = 0;   ///< α if it is constant
  double initial_ = 0, initial_terms_ = 0, exponent_ = 0, change_ = 0, residual_ = 0, of_steps_ = 0, of_reading_ = 0;
  RunState before_;
};

}  // namespace

std::unique_ptr<Diagnostic> decay_diagnostic(const RunBackend& backend, const Request&, const KeepGoing&) {
  return std::make_unique<Decay>(backend);
}

}  // namespace least
