// energy, momenta: how far a run departs from what its motion conserves, with secular drift separate from oscillation.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>
#include <utility>

#include "core/run/diagnostics/drift.hpp"
#include "core/run/diagnostics/rows.hpp"
#include "core/run/hermite.hpp"

namespace least {
namespace {

/// LinearTrend is the least-squares slope of a quantity against time, which starts at 0: its secular drift without its
/// oscillation. It is fitted to the straight lines between the values seen, so that each counts for its duration,
/// whatever the steps.
struct LinearTrend {
  double t = 0, y = 0, area = 0, moment = 0;  ///< last time and value; ∫y dt and ∫ty dt up to them
  void see(double time, double value) {
    const double step = time - t, sum = y + value;
    area += 0.5 * step * sum;
    moment += step / 6 * (t * (y + sum) + time * (value + sum));
    t = time;
    y = value;
  }
  double slope() const { return 12 * (moment / t - 0.5 * area) / (t * t); }
};

/// Peak is the largest value of a quantity that is seen at separate times: between them that of the parabola through
/// the last three values, if the middle one is the largest.
struct Peak {
  double most = -std::numeric_limits<double>::infinity();
  void see(double time, double value) {
    constexpr double far = 8;  // intervals that differ by more than this factor are not used together
    const double before = t_[1] - t_[0], after = time - t_[1], rise = y_[1] - y_[0], fall = y_[1] - value;
    most = std::max(most, value);
    if (rise >= 0 && fall >= 0 && before > 0 && after > 0 && before < far * after && after < far * before) {
      const double slope = (rise * after / before - fall * before / after) / (before + after);
      const double bend = (rise / before + fall / after) / (before + after);
      if (bend > 0) most = std::max(most, y_[1] + slope * slope / (4 * bend));
    }
    t_ = {t_[1], time};
    y_ = {y_[1], value};
  }

 private:
  std::array<double, 2> t_{unknown, unknown}, y_{};
};

/// Number of states whose energies, or invariants, are computed at once.
constexpr std::size_t at_once = 64;

/// Energy follows the energy of a run; for a forced scene it follows H − W, which the motion conserves if H does not
/// depend on time. If the energy starts at zero, its errors are relative to the largest kinetic energy of the run, or
/// for a flow, which has none, to the largest size of the energy; `relative_to` tells which. Steps of a scheme with its
/// own clock may be as long as an oscillation of the motion: an energy that the motion changes is then looked for
/// within steps as well. A conserved energy is only that of the ends of steps, whatever dense output makes of it
/// between them.
class Energy final : public Diagnostic {
 public:
  /// `long_steps`: steps may be that long; `smooth`: they have an error estimate; `changes`: the motion does not
  /// conserve the energy.
  Energy(bool long_steps, bool smooth, bool changes) : long_steps_(long_steps), smooth_(smooth), changes_(changes) {}

  void start(const ProblemTable& problem, StateView x) override {
    seen_.start_time = x.t;
    seen_.energy.start(problem.energy_of(x));
    at_step_ = seen_.energy.initial;
    seen_.largest = problem.traits.potential ? problem.energy_terms(x).kinetic : std::abs(seen_.energy.initial);
    peaks_.size.see(0, seen_.largest);
    peaks_.gain.see(0, 0);
    peaks_.loss.see(0, 0);
    keep(problem, x);
  }
  void see(const ProblemTable& problem, StateView x) override {
    if (changes_ && smooth_ && !looked_ && looks()) look_along(problem, x);
    take(problem, x, true);
    keep(problem, x);
    most_in_a_step_ = std::max(most_in_a_step_, std::abs(seen_.energy.final - at_step_));
    at_step_ = seen_.energy.final;
    ++steps_;
    looked_ = false;
  }
  /// While steps are few. If there are many, their ends meet all phases of a periodic motion, and parabolas through
  /// them find what changes little in a step: otherwise each step is looked into.
  bool looks() const override {
    constexpr std::int64_t few = 256;
    constexpr double much = 0.3;
    const double range = std::max(peaks_.gain.most, 0.0) + std::max(peaks_.loss.most, 0.0);
    return long_steps_ && (steps_ < few || (changes_ && most_in_a_step_ > much * range));
  }
  void look(const ProblemTable& problem, StateView x) override {
    if (!std::exchange(looked_, true)) {
      seen_at_step_ = seen_;
      peaks_at_step_ = peaks_;
    }
    if (std::isfinite(problem.energy_terms(x).total)) take(problem, x, changes_);
  }
  void look_again() override {
    if (!std::exchange(looked_, false)) return;
    seen_ = seen_at_step_;
    peaks_ = peaks_at_step_;
  }
  void see(const ProblemTable& problem, const StateRows& states) override {
    std::array<EnergyTerms, at_once> terms;
    EnergyRecord seen = seen_;  // a local copy, which may stay in registers
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
    const double largest = std::max(seen_.largest, peaks_.size.most);
    double most = energy.most;
    if (changes_) most = std::max({most, peaks_.gain.most, peaks_.loss.most});
    const double initial = std::abs(energy.initial), scale = std::max(initial, largest);
    Report report = numbers("energy", {{"initial", energy.initial},
                                       {"final", energy.final + work_of(traits, end.x)},
                                       {"max_abs_error", most},
                                       {"max_rel_error", scale > 0 ? most / scale : unknown},
                                       {"drift_per_time", seen_.trend.slope()}});
    const std::string_view what = !traits.potential   ? "largest energy"
                                  : largest > initial ? "largest kinetic energy"
                                                      : "initial energy";
    insert(report, 4, words("relative_to", scale > 0 ? what : ""));
    if (traits.forced) insert(report, 2, {"work", work_of(traits, end.x)});
    return report;
  }

 private:
  struct EnergyRecord {
    DriftExtremes energy;
    LinearTrend trend;
    double start_time = 0, largest = 0;  ///< largest: the largest kinetic energy, or size of the energy

    void see(double t, const EnergyTerms& terms, bool kinetic, double work) {
      energy.see(terms.total - work);
      largest = std::max(largest, kinetic ? terms.kinetic : std::abs(terms.total));
      trend.see(t - start_time, terms.total - work - energy.initial);
    }
  };
  struct EnergyPeaks {
    Peak size, gain, loss;  ///< of the quantity of `largest`, and of the energy relative to the start
  };

  /// Looks at states within a step without dense output, by a Hermite polynomial.
  void look_along(const ProblemTable& problem, StateView x) {
    constexpr int parts = 12;
    const HermitePath path(problem, before_, x);
    for (int i = 1; i < parts; ++i) look(problem, path(before_.t + i * (x.t - before_.t) / parts));
  }
  void keep(const ProblemTable& problem, StateView x) {
    if (!changes_ || !smooth_ || !looks()) return;
    before_.t = x.t;
    before_.numbers.assign(x.numbers, x.numbers + problem.traits.numbers);
  }
  /// `counts`: whether the state counts for the energy, or only for the size that errors are relative to.
  void take(const ProblemTable& problem, StateView x, bool counts) {
    const EnergyTerms terms = problem.energy_terms(x);
    const double work = work_of(problem.traits, x);
    if (counts) seen_.see(x.t, terms, problem.traits.potential, work);
    if (!long_steps_) return;
    const double time = x.t - seen_.start_time, change = terms.total - work - seen_.energy.initial;
    peaks_.size.see(time, problem.traits.potential ? terms.kinetic : std::abs(terms.total));
    if (!changes_) return;
    peaks_.gain.see(time, change);
    peaks_.loss.see(time, -change);
  }

  bool long_steps_, smooth_, changes_;
  bool looked_ = false;                      ///< whether states within the next step have been looked at
  double at_step_ = 0, most_in_a_step_ = 0;  ///< the energy at the end of the last step, and the largest change in one
  std::int64_t steps_ = 0;
  EnergyRecord seen_, seen_at_step_;  ///< at present, and at the end of the last step
  EnergyPeaks peaks_, peaks_at_step_;
  RunState before_;  ///< at the end of the last step
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
    const auto& names = end.scene.card().invariants;  // fewer than the capacity of its class, possibly
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

std::unique_ptr<Diagnostic> energy_diagnostic(const RunBackend& backend, const Request& request, const KeepGoing&) {
  const ProblemTraits& traits = backend.table().traits;
  const SchemeCard& scheme = request.scene->mechanics->schemes()[request.scheme];
  const bool long_steps = scheme.own_clock && (traits.potential || !traits.keeps_energy);
  // Under forces it is the energy without their work that counts, which the motion conserves.
  const bool changes = !traits.keeps_energy && !traits.forced;
  return std::make_unique<Energy>(long_steps, scheme.find("tolerance").has_value(), changes);
}
std::unique_ptr<Diagnostic> momenta_diagnostic(const RunBackend&, const Request&, const KeepGoing&) {
  return std::make_unique<Momenta>();
}

}  // namespace least
