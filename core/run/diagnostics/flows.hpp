// entropy, moments: what a flow that is not mechanical may have.
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "core/run/diagnostics/conserved.hpp"

namespace least {

struct EntropyRow {
  static constexpr DiagnosticCard info{"entropy", "whether the entropy ever fell"};
  static constexpr Sees sees = Sees::every_step;
  template <class P>
  static constexpr bool applies = HasEntropy<P>;

  template <class P, class X>
  struct Seen {
    DriftExtremes entropy;
    bool monotone = true;

    void start(const P& problem, const X& x) { entropy.start(problem.entropy(x.y)); }
    void see(const P& problem, const X& x) {
      const double now = problem.entropy(x.y);
      constexpr double grain = 4 * std::numeric_limits<double>::epsilon();
      monotone = monotone && now >= entropy.final - grain * (1 + std::abs(now));
      entropy.see(now);
    }
    Report report(const RunEnd<P, X>&) const {
      Report said{"monotone", std::monostate{}};
      if (std::isfinite(entropy.most)) said.value = monotone;
      Report report = numbers("entropy", {{"initial", entropy.initial}, {"final", entropy.final}});
      insert(report, 2, std::move(said));
      return report;
    }
  };
};

struct MomentsRow {
  static constexpr DiagnosticCard info{"moments", "averages along the orbit"};
  static constexpr Sees sees = Sees::every_step;
  template <class P>
  static constexpr bool applies = HasMoments<P>;

  template <class P, class X>
  struct Seen {
    std::array<double, P::moment_names.size()> sums{};
    double weight = 0, log_weight = -std::numeric_limits<double>::infinity();

    void start(const P&, const X&) {}
    void see(const P& problem, const X& x) {
      // Weights relative to the largest yet, which cannot underflow together.
      const double here = problem.log_weight(x.y), largest = std::max(here, log_weight);
      const double past = std::exp(log_weight - largest), w = std::exp(here - largest);
      const auto values = problem.moments(x.y);
      log_weight = largest;
      weight = past * weight + w;
      for (std::size_t i = 0; i < values.size(); ++i) sums[i] = past * sums[i] + w * values[i];
    }
    Report report(const RunEnd<P, X>&) const {
      std::vector<Report> all;
      for (std::size_t i = 0; i < sums.size(); ++i) all.push_back({std::string(P::moment_names[i]), sums[i] / weight});
      return {"moments", all};
    }
  };
};

}  // namespace least
