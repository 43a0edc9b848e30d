// energy, momenta: how far a run departs from what its motion keeps; drift apart from oscillation.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "core/run/diagnostics/diagnostic.hpp"

namespace least {

/// The energy can be said from a state X.
template <class P, class X>
concept SaysEnergy = HasEnergy<P> &&(!Contact<P> || X::acting);

/// Extremes of one quantity along a run; unknown until it starts.
struct DriftExtremes {
  double initial = unknown, final = unknown, most = unknown;
  void start(double x) {
    initial = final = x;
    most = 0;
  }
  void see(double x) {
    final = x;
    const double change = std::abs(x - initial);
    if (!(change <= most)) most = change;  // NaN comes in and stays
  }
};

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

/// Where an energy begins at zero its errors are still small or large: against the largest kinetic energy of the run,
/// or, of a flow, which has none, against the largest size of the energy itself. `relative_to` says against what.
struct EnergyRow {
  static constexpr DiagnosticCard info{"energy", "extremes and drift of the energy", true, true};
  static constexpr Sees sees = Sees::every_step;
  template <class P>
  static constexpr bool applies = HasEnergy<P>;

  template <class P, class X>
  struct Seen {
    DriftExtremes energy;
    LinearTrend trend;
    double start_time = 0, largest = 0;  ///< of the kinetic energy

    void start(const P& problem, const X& x) {
      start_time = x.t;
      energy.start(energy_of(problem, x));
      largest = size(problem, x, energy.initial);
      trend.see(0, 0);
    }
    void see(const P& problem, const X& x) {
      const double h = least::energy(problem, x);
      energy.see(h);
      largest = std::max(largest, size(problem, x, h));
      trend.see(x.t - start_time, h - energy.initial);
    }
    Report report(const RunEnd<P, X>&) const {
      const double initial = std::abs(energy.initial), scale = std::max(initial, largest);
      Report report = numbers("energy", {{"initial", energy.initial},
                                         {"final", energy.final},
                                         {"max_abs_error", energy.most},
                                         {"max_rel_error", scale > 0 ? energy.most / scale : unknown},
                                         {"drift_per_time", trend.slope()}});
      const std::string_view what = !Potential<P>       ? "largest energy"
                                    : largest > initial ? "largest kinetic energy"
                                                        : "initial energy";
      insert(report, 4, words("relative_to", scale > 0 ? what : ""));
      return report;
    }

   private:
    static double size(const P& problem, [[maybe_unused]] const X& x, [[maybe_unused]] double h) {
      if constexpr (Potential<P>) {
        return 0.5 * dot(x.p, velocity(problem, x.q, x.p));
      } else {
        return std::abs(h);
      }
    }
  };
};

struct MomentaRow {
  static constexpr DiagnosticCard info{"momenta", "extremes of what else the motion keeps"};
  static constexpr Sees sees = Sees::every_step;
  template <class P>
  static constexpr bool applies = Potential<P> || GeneralHamiltonian<P> || HasInvariants<P>;

  template <class P, class X>
  struct Seen {
    static constexpr std::size_t count() {
      if constexpr (HasInvariants<P>) {
        return std::tuple_size_v<decltype(invariants_at(P{}, StateOf<P>{}))>;
      } else {
        return 0;
      }
    }
    std::array<DriftExtremes, count()> invariants{};

    void start([[maybe_unused]] const P& problem, [[maybe_unused]] const X& x) {
      if constexpr (HasInvariants<P>) {
        const auto values = invariants_at(problem, x);
        for (std::size_t i = 0; i < values.size(); ++i) invariants[i].start(values[i]);
      }
    }
    void see([[maybe_unused]] const P& problem, [[maybe_unused]] const X& x) {
      if constexpr (HasInvariants<P>) {
        const auto values = invariants_at(problem, x);
        for (std::size_t i = 0; i < values.size(); ++i) invariants[i].see(values[i]);
      }
    }
    Report report(const RunEnd<P, X>& end) const {
      std::vector<Report> all;
      const auto& names = end.scene.card().invariants;  // of a capacity it may use a part only
      for (std::size_t i = 0; i < std::min(invariants.size(), names.size()); ++i) {
        const DriftExtremes& one = invariants[i];
        all.push_back(
            numbers(names[i].name, {{"initial", one.initial}, {"final", one.final}, {"max_abs_error", one.most}}));
      }
      return {"momenta", all};
    }
  };
};

}  // namespace least
