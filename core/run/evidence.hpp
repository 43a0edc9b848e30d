// Evidence of whether a run is any good, gathered from its states whatever was asked for: between blocks of steps, 16
// times in a short run, at every 256th step of a long one and at longer strides as the run goes on. States after 1, 2,
// 4, … steps are looked at before the first of these, since a run of a decaying motion is wrong at once or not at all.
// Steps do not pay for it, and what is seen depends on the run alone.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "core/memory_budget.hpp"
#include "core/run/integrator.hpp"

namespace least {

class Evidence {
 public:
  /// `steps`: the number of steps of the run, if it is known. `keeps`: whether to keep the states that are looked at.
  Evidence(const ProblemTraits& traits, std::optional<std::int64_t> steps, bool keeps)
      : looks_(keeps || traits.keeps_energy || (traits.quadratic_contact && steps)),
        keeps_(keeps),
        stride_(steps ? std::clamp<std::int64_t>(*steps / 16, 1, 256) : 16),
        begun_(stride_) {}

  /// The number of the next step after n whose state is looked at.
  std::int64_t next(std::int64_t n) const {
    if (!looks_) return std::numeric_limits<std::int64_t>::max();
    return n < begun_ ? std::min(std::max<std::int64_t>(2 * n, 1), begun_) : (n / stride_ + 1) * stride_;
  }
  void start(const ProblemTable& problem, StateView x) {
    started_ = true;
    if (problem.traits.keeps_energy) level_ = found_.before = found_.now = problem.energy_of(x);
    look(problem, x);
  }
  /// To be called with the state after each block.
  void see(const ProblemTable& problem, const IntegrationState& state) {
    const bool early = state.n < begun_ && std::has_single_bit(static_cast<std::uint64_t>(state.n));
    if (!looks_ || (!early && state.n % stride_ != 0)) return;
    look(problem, state.x);
    keep(state.x, problem.traits.moving);
    if (early) {
      ++early_;
      return;
    }
    if (++seen_ < most_looks) return;
    seen_ /= 2;
    stride_ *= 2;
    if (!keeps_) return;
    const auto later = states_.begin() + early_;
    for (std::ptrdiff_t i = 0; i < seen_; ++i) later[i] = later[2 * i + 1];
    const std::size_t left = static_cast<std::size_t>(early_ + seen_);
    held_.shrink_by(held_.bytes() / states_.size() * (states_.size() - left));
    states_.resize(left);
  }
  void finish(const ProblemTable& problem, const IntegrationState& state) {
    if (!started_) return;
    look(problem, state.x);
    if (states_.empty() || states_.back().t < state.x.t) keep(state.x, problem.traits.moving);
  }

  /// The energy E, where the motion conserves it: `off` is its largest change in units of max(|E₀|, |V| + |E − V|),
  /// `before` is E₀ at the start, and `now` the value farthest from E₀. All 0 where it is not conserved.
  struct Energy {
    double off = 0, before = 0, now = 0;
  };
  const Energy& energy() const { return found_; }
  /// The largest rate of damping |γs| seen, where H has γs²/2.
  double damping() const { return damping_; }
  /// The states looked at after the start, in order of time, with only those components that the motion needs.
  std::span<const RunState> states() const { return states_; }

 private:
  static constexpr std::int64_t most_looks = 256;

  void look(const ProblemTable& problem, StateView x) {
    if (problem.traits.keeps_energy) {
      const EnergyTerms terms = problem.energy_terms(x);
      const double now = terms.total;
      double size = std::abs(now);
      if (problem.traits.potential) size = std::abs(terms.potential) + std::abs(now - terms.potential);
      const double off = std::abs(now - level_) / std::max({std::abs(level_), size, 1e-300});
      found_.off = std::max(found_.off, off);
      if (std::abs(now - level_) > std::abs(found_.now - level_)) found_.now = now;
    }
    if (problem.traits.quadratic_contact)
      damping_ = std::max(damping_, std::abs(x[2 * problem.traits.dof] * problem.action_curvature()));
  }

  void keep(const RunState& x, std::size_t moving) {
    if (!keeps_) return;
    constexpr std::size_t copies = 2;  // as many are held again for the states that these are compared with
    held_.add(copies * moving * sizeof(double));
    states_.push_back({x.t, StateNumbers(x.numbers.begin(), x.numbers.begin() + std::ptrdiff_t(moving))});
  }

  bool looks_;  ///< for a conserved energy, for a damping that equal steps may not resolve, or to keep states
  bool keeps_, started_ = false;
  std::int64_t stride_, begun_;  ///< current stride; first stride, up to which steps 1, 2, 4, … are looked at
  std::int64_t seen_ = 0, early_ = 0;
  std::vector<RunState> states_;
  Held held_ = HeldByThread::take(0);  ///< memory of the states
  double level_ = 0, damping_ = 0;
  Energy found_;
};

}  // namespace least
