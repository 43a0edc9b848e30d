// decay: the law of decay of a contact Hamiltonian, Ḣ = −H H_s + H_t, along the states a scheme took. With A = ∫H_s dt
// and G = ∫H_t eᴬ dt the exact motion keeps H eᴬ − G. So over a step from x to y, from which the exact flow leads from
// x to z, H eᴬ − G changes by eᴬ (H(y) − H(z)): nothing has to be integrated but the motion itself, and that to
// round-off. A constant damping without a drive is simpler still: G = 0 and A = αt. Source: Bravetti, Cruz, Tapias,
// Ann. Phys. 376, 17 (2017), eq. 22.

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
    std::array<EnergyTerms, 64> terms;  // of states whose energies are computed at once
    for (std::size_t from = 0; from < states.count; from += terms.size()) {
      const StateRows part = states.part(from, terms.size());
      problem.energy_terms(part, terms.data());
      for (std::size_t i = 0; i < part.count; ++i) see(problem, part[i], terms[i]);
    }
  }

  /// max_residual: the largest change of H eᴬ − G; floor: what rounding alone makes of it. Both relative to |H| at the
  /// start, absolute where H begins at zero.
  Report report(const RunEnd&) override {
    const double scale = std::abs(initial_) > 1e-9 * initial_terms_ ? std::abs(initial_) : 1;
    return numbers("decay", {{"max_residual", residual_ / scale}, {"floor", floor() / scale}});
  }

 private:
  void see(const ProblemTable& problem, StateView x, const EnergyTerms& terms) {
    if (std::isnan(residual_))
      return;  // nothing more can be learnt, and where a flow is not followed it is dear to try
    exponent_ += damping_between(problem, before_, x);
    const double grown = std::exp(exponent_);
    if (closed_) {
      change_ = terms.total * grown - initial_;
    } else {
      change_ += grown * (terms.total - backend_.energy_after(before_, x.t));
    }
    const double wrong = std::abs(change_);
    if (!(wrong <= residual_)) residual_ = wrong;  // NaN comes in and stays
    see_rounding(problem, x, terms, grown);
    keep(problem, x);
  }
  void keep(const ProblemTable& problem, StateView x) {
    before_.t = x.t;
    if (!closed_) before_.numbers.assign(x.numbers, x.numbers + problem.traits.numbers);
  }
  /// ∫H_s dt: exact for a constant damping; else it only weighs what a step did wrong, and Simpson's rule will do.
  double damping_between(const ProblemTable& problem, StateView a, StateView b) const {
    const double h = b.t - a.t;
    if (problem.traits.constant_damping) return h * damping_;
    const std::size_t action = 2 * problem.traits.dof;
    const double middle = problem.action_slope((a[action] + b[action]) / 2, a.t + h / 2);
    return h / 6 * (problem.action_slope(a[action], a.t) + 4 * middle + problem.action_slope(b[action], b.t));
  }

  /// Each step rounds its state by a unit of the terms of H, at worst always the same way (the weights of a composition
  /// do: 1.5e-12 after 2,000 steps of order 10), and the law is read off to some units more. The sum of the terms.
  /// `grown`: eᴬ.
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
  bool closed_ = false;  ///< the law has a closed form
  double damping_ = 0;   ///< where it is constant
  double initial_ = 0, initial_terms_ = 0, exponent_ = 0, change_ = 0, residual_ = 0, of_steps_ = 0, of_reading_ = 0;
  RunState before_;
};

}  // namespace

std::unique_ptr<Diagnostic> decay_diagnostic(const RunBackend& backend, const Request&, const KeepGoing&) {
  return std::make_unique<Decay>(backend);
}

}  // namespace least
