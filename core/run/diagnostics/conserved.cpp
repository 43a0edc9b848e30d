// energy, momenta: how far a run departs from what its motion keeps; drift apart from oscillation.

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "core/run/diagnostics/drift.hpp"
#include "core/run/diagnostics/rows.hpp"

namespace least {
namespace {

/// Least-squares slope of a quantity against time: its secular drift, apart from its oscillation.
struct LinearTrend {
  double n = 0, t = 0, tt = 0, y = 0, ty = 0;
  void see(double time, double value) {
    n += 1;
    t += time;
    tt += time * time;
    y += value;
    ty += time * value;
  }
  double slope() const { return (n * ty - t * y) / (n * tt - t * t); }
};

/// States whose energies, or invariants, are computed at once.
constexpr std::size_t at_once = 64;

/// What is looked at of a forced scene is H − W, which its motion keeps where H does not depend on time.
/// Where an energy begins at zero its errors are still small or large: against the largest kinetic energy of the run,
/// or, of a flow, which has none, against the largest size of the energy itself. `relative_to` says against what.
class Energy final : public Diagnostic {
 public:
  void start(const ProblemTable& problem, StateView x) override {
    seen_.start_time = x.t;
    seen_.energy.start(problem.energy_of(x));
    seen_.largest = problem.traits.potential ? problem.energy_terms(x).kinetic : std::abs(seen_.energy.initial);
    seen_.trend.see(0, 0);
  }
  void see(const ProblemTable& problem, StateView x) override {
    const EnergyTerms terms = problem.energy_terms(x);
    seen_.see(x.t, terms, problem.traits.potential, work_of(problem.traits, x));
  }
  void see(const ProblemTable& problem, const StateRows& states) override {
    std::array<EnergyTerms, at_once> terms;
    EnergyRecord seen = seen_;  // which may stay in registers
    const bool kinetic = problem.traits.potential;
    for (std::size_t from = 0; from < states.count; from += at_once) {
      const StateRows part = states.part(from, at_once);
      problem.energy_terms(part, terms.data());
      for (std::size_t i = 0; i < part.count; ++i) {
        const StateView x = part[i];
        seen.see(x.t, terms[i], kinetic, work_of(problem.traits, x));
      }
    }
    seen_ = seen;
  }
  Report report(const RunEnd& end) override {
    const DriftExtremes& energy = seen_.energy;
    const ProblemTraits& traits = end.problem.traits;
    const double initial = std::abs(energy.initial), scale = std::max(initial, seen_.largest);
    Report report = numbers("energy", {{"initial", energy.initial},
                                       {"final", energy.final + work_of(traits, end.x)},
                                       {"max_abs_error", energy.most},
                                       {"max_rel_error", scale > 0 ? energy.most / scale : unknown},
                                       {"drift_per_time", seen_.trend.slope()}});
    const std::string_view what = !traits.potential         ? "largest energy"
                                  : seen_.largest > initial ? "largest kinetic energy"
                                                            : "initial energy";
    insert(report, 4, words("relative_to", scale > 0 ? what : ""));
    if (traits.forced) insert(report, 2, {"work", work_of(traits, end.x)});
    return report;
  }

 private:
  struct EnergyRecord {
    DriftExtremes energy;
    LinearTrend trend;
    double start_time = 0, largest = 0;  ///< largest: of the kinetic energy, or of the size of the energy itself

    void see(double t, const EnergyTerms& terms, bool kinetic, double work) {
      energy.see(terms.total - work);
      largest = std::max(largest, kinetic ? terms.kinetic : std::abs(terms.total));
      trend.see(t - start_time, terms.total - work - energy.initial);
    }
  };

  EnergyRecord seen_;
};

class Momenta final : public Diagnostic {
 public:
  void start(const ProblemTable& problem, StateView x) override {
    invariants_.resize(problem.traits.invariants);
    values_.resize(at_once * problem.traits.invariants);
    problem.invariants(x, values_.data());
    for (std::size_t i = 0; i < invariants_.size(); ++i) invariants_[i].start(values_[i]);
  }
  void see(const ProblemTable& problem, StateView x) override {
    problem.invariants(x, values_.data());
    for (std::size_t i = 0; i < invariants_.size(); ++i) invariants_[i].see(values_[i]);
  }
  void see(const ProblemTable& problem, const StateRows& states) override {
    const std::size_t count = invariants_.size();
    for (std::size_t from = 0; from < states.count && count > 0; from += at_once) {
      const StateRows part = states.part(from, at_once);
      problem.invariants(part, values_.data());
      for (std::size_t i = 0; i < count; ++i) {
        DriftExtremes seen = invariants_[i];
        for (std::size_t k = 0; k < part.count; ++k) seen.see(values_[k * count + i]);
        invariants_[i] = seen;
      }
    }
  }
  Report report(const RunEnd& end) override {
    std::vector<Report> all;
    const auto& names = end.scene.card().invariants;  // of a capacity it may use a part only
    invariants_.resize(end.problem.traits.invariants);
    for (std::size_t i = 0; i < std::min(invariants_.size(), names.size()); ++i) {
      const DriftExtremes& one = invariants_[i];
      all.push_back(
          numbers(names[i].name, {{"initial", one.initial}, {"final", one.final}, {"max_abs_error", one.most}}));
    }
    return {"momenta", all};
  }

 private:
  std::vector<DriftExtremes> invariants_;
  std::vector<double> values_;
};

}  // namespace

std::unique_ptr<Diagnostic> energy_diagnostic(const RunBackend&, const Request&, const KeepGoing&) {
  return std::make_unique<Energy>();
}
std::unique_ptr<Diagnostic> momenta_diagnostic(const RunBackend&, const Request&, const KeepGoing&) {
  return std::make_unique<Momenta>();
}

}  // namespace least
