// Diagnostics that look at every step. Values, so that a block of steps can be taken back.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/run/decay.hpp"
#include "core/run/orbit.hpp"
#include "core/run/outcome.hpp"
#include "core/scene.hpp"

namespace least {

/// Where a run is: a state, and how many whole steps it has behind it.
template <class X>
struct Place {
  X x;
  std::int64_t n = 0;
};

/// Extremes of one quantity along a run; unknown until it starts.
struct Trace {
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
struct Trend {
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

/// The energy can be said from a state X.
template <class P, class X>
concept SaysEnergy = HasEnergy<P> &&(!Contact<P> || X::acting);

template <class P, class X>
class Observer {
 public:
  bool energy = false, momenta = false, orbit = false, decay = false, entropy = false, moments = false,
       sections = false;
  bool crossed = false;  ///< a section changed its sign since this was last cleared

  bool wanted() const { return energy || momenta || orbit || decay || entropy || moments || sections; }

  void start(const P& problem, const X& x) {
    start_time_ = x.t;
    if constexpr (SaysEnergy<P, X>) {
      if (energy) energy_.start(energy_of(problem, x));
      if (energy) trend_.see(0, 0);
    }
    if constexpr (HasInvariants<P>) {
      if (momenta) {
        const auto values = problem.invariants(x.q, x.p, x.t);
        for (std::size_t i = 0; i < values.size(); ++i) invariants_[i].start(values[i]);
      }
    }
    if constexpr (TwoBody<P>) {
      if (orbit) orbit_.start(problem, x);
    }
    if constexpr (Contact<P> && X::acting) {
      if (decay) decay_.start(problem, x);
    }
    if constexpr (HasEntropy<P>) entropy_.start(problem.entropy(x.y));
    before_ = least::sections(problem, x);
  }

  void see(const P& problem, const X& x) {
    if constexpr (SaysEnergy<P, X>) {
      if (energy) {
        const double h = least::energy(problem, x);
        energy_.see(h);
        trend_.see(x.t - start_time_, h - energy_.initial);
      }
    }
    if constexpr (HasInvariants<P>) {
      if (momenta) {
        const auto values = problem.invariants(x.q, x.p, x.t);
        for (std::size_t i = 0; i < values.size(); ++i) invariants_[i].see(values[i]);
      }
    }
    if constexpr (TwoBody<P>) {
      if (orbit) orbit_.see(x);
    }
    if constexpr (Contact<P> && X::acting) {
      if (decay) decay_.see(problem, x);
    }
    if constexpr (HasEntropy<P>) {
      if (entropy) {
        const double now = problem.entropy(x.y);
        constexpr double grain = 4 * std::numeric_limits<double>::epsilon();
        monotone_ = monotone_ && now >= entropy_.final - grain * (1 + std::abs(now));
        entropy_.see(now);
      }
    }
    if constexpr (HasMoments<P>) {
      if (moments) {
        // Weights relative to the largest yet, which cannot underflow together.
        const double here = problem.log_weight(x.y), largest = std::max(here, log_weight_);
        const double past = std::exp(log_weight_ - largest), w = std::exp(here - largest);
        const auto values = problem.moments(x.y);
        log_weight_ = largest;
        weight_ = past * weight_ + w;
        for (std::size_t i = 0; i < values.size(); ++i) moments_[i] = past * moments_[i] + w * values[i];
      }
    }
    if (sections) {
      const auto now = least::sections(problem, x);
      for (std::size_t i = 0; i < now.size(); ++i) crossed = crossed || (now[i] < 0) != (before_[i] < 0);
      before_ = now;
    }
  }

  Report energy_report() const {
    return numbers("energy", {{"initial", energy_.initial},
                              {"final", energy_.final},
                              {"max_abs_error", energy_.most},
                              {"max_rel_error", energy_.most / std::abs(energy_.initial)},
                              {"drift_per_time", trend_.slope()}});
  }
  Report momenta_report(const ProblemCard& card) const {
    std::vector<Report> all;
    std::size_t i = 0;
    for (const Trace& trace : invariants_)
      all.push_back(numbers(card.invariants[i++].name,
                            {{"initial", trace.initial}, {"final", trace.final}, {"max_abs_error", trace.most}}));
    return {"momenta", all};
  }
  Report orbit_report(const X& x) const {
    if constexpr (TwoBody<P>) {
      return orbit_.report(x);
    } else {
      return {"orbit", {}};
    }
  }
  Report decay_report() const {
    double residual = unknown;
    if constexpr (Contact<P> && X::acting) residual = decay_.max_residual();
    return numbers("decay", {{"max_residual", residual}});
  }
  Report entropy_report() const {
    Report monotone{"monotone", std::monostate{}};
    if (std::isfinite(entropy_.most)) monotone.value = monotone_;
    Report report = numbers("entropy", {{"initial", entropy_.initial}, {"final", entropy_.final}});
    insert(report, 2, std::move(monotone));
    return report;
  }
  Report moments_report() const {
    std::vector<Report> all;
    if constexpr (HasMoments<P>)
      for (std::size_t i = 0; i < moments_.size(); ++i) all.push_back({P::moment_names[i], moments_[i] / weight_});
    return {"moments", all};
  }

 private:
  template <bool Has>
  static constexpr std::size_t invariant_count() {
    if constexpr (Has) {
      return std::tuple_size_v<decltype(P{}.invariants(Vec<P::dof>{}, Vec<P::dof>{}, 0.0))>;
    } else {
      return 0;
    }
  }
  static constexpr std::size_t moment_count() {
    if constexpr (HasMoments<P>) {
      return P::moment_names.size();
    } else {
      return 0;
    }
  }
  struct Nothing {};
  template <bool Has, template <class> class Track>
  struct Maybe {
    using type = Nothing;
  };
  template <template <class> class Track>
  struct Maybe<true, Track> {
    using type = Track<P>;
  };

  Trace energy_, entropy_;
  Trend trend_;
  double start_time_ = 0, weight_ = 0, log_weight_ = -std::numeric_limits<double>::infinity();
  bool monotone_ = true;
  std::array<Trace, invariant_count<HasInvariants<P>>()> invariants_{};
  std::array<double, moment_count()> moments_{};
  decltype(least::sections(std::declval<const P&>(), std::declval<const X&>())) before_{};
  [[no_unique_address]] typename Maybe<TwoBody<P>, OrbitTrack>::type orbit_{};
  [[no_unique_address]] typename Maybe<(Contact<P> && X::acting), DecayLaw>::type decay_{};
};

}  // namespace least
