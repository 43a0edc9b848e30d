// entropy, moments: what a flow that is not mechanical may have.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "core/run/diagnostics/conserved.hpp"
#include "core/run/hermite.hpp"

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

/// An average over time of several quantities, weighted by numbers that are known by their logarithm.
template <std::size_t N>
class TimeAverage {
 public:
  void add(double time, double log_weight, const std::array<double, N>& values) {
    // Weights relative to the largest yet, which cannot underflow together.
    const double largest = std::max(log_weight, log_weight_);
    const double past = std::exp(log_weight_ - largest), w = time * std::exp(log_weight - largest);
    log_weight_ = largest;
    weight_ = past * weight_ + w;
    for (std::size_t i = 0; i < N; ++i) sums_[i] = past * sums_[i] + w * values[i];
  }
  /// Unknown before there is any time.
  double operator[](std::size_t i) const { return sums_[i] / weight_; }

 private:
  std::array<double, N> sums_{};
  double weight_ = 0, log_weight_ = -std::numeric_limits<double>::infinity();
};

/// Over time, whatever the steps: by Gauss' rule of three points over each step, between whose ends the states come
/// from Hermite interpolation (order 6). Its weights are positive, so that no average leaves the range of its values.
struct MomentsRow {
  static constexpr DiagnosticCard info{"moments", "averages over time along the orbit"};
  static constexpr Sees sees = Sees::every_step;
  template <class P>
  static constexpr bool applies = HasMoments<P>;

  template <class P, class X>
  struct Seen {
    static constexpr std::size_t count = P::moment_names.size();
    TimeAverage<count> target, physical;
    X before{};

    void start(const P&, const X& x) { before = x; }
    void see(const P& problem, const X& x) {
      const HermitePath<P, X> path(problem, before, x);
      const double h = x.t - before.t, off = std::sqrt(0.15) * h;
      const double middle = before.t + h / 2;
      for (const auto& [t, part] : {std::pair{middle - off, 5.0}, {middle, 8.0}, {middle + off, 5.0}}) {
        const X y = path(t);
        const auto values = problem.moments(y.y);
        target.add(h * part / 18, problem.log_weight(y.y), values);
        physical.add(h * part / 18, problem.log_rate(y.y), values);
      }
      before = x;
    }
    /// The target's averages, and beside them those over physical time.
    Report report(const RunEnd<P, X>&) const {
      std::vector<Report> all = named(target);
      all.push_back({"physical_time", named(physical)});
      return {"moments", all};
    }

   private:
    static std::vector<Report> named(const TimeAverage<count>& average) {
      std::vector<Report> all;
      for (std::size_t i = 0; i < count; ++i) all.push_back({std::string(P::moment_names[i]), average[i]});
      return all;
    }
  };
};

}  // namespace least
