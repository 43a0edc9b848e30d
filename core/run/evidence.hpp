// What the states of a run say of its worth, whatever was asked for: looked at between blocks of steps, 16 times in a
// short run, at every 256th step of a long one and at longer strides as it goes on, and after 1, 2, 4, … steps before
// the first of these: what decays is wrong at once or not at all. No step pays for it, and what is seen depends on the
// run alone.
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
  /// `steps`: how many there are to be, where that is known. `keeps`: the states that are looked at are kept.
  Evidence(const ProblemTraits& traits, std::optional<std::int64_t> steps, bool keeps)
      : looks_(keeps || traits.keeps_energy || (traits.quadratic_contact && steps)),
        keeps_(keeps),
        stride_(steps ? std::clamp<std::int64_t>(*steps / 16, 1, 256) : 16),
        begun_(stride_) {}

  /// The next step to be looked at after the n-th.
  std::int64_t next(std::int64_t n) const {
    if (!looks_) return std::numeric_limits<std::int64_t>::max();
    return n < begun_ ? std::min(std::max<std::int64_t>(2 * n, 1), begun_) : (n / stride_ + 1) * stride_;
  }
  void start(const ProblemTable& problem, StateView x) {
    started_ = true;
    if (problem.traits.keeps_energy) level_ = found_.before = found_.now = problem.energy_of(x);
    look(problem, x);
  }
  /// The state after a block.
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

  /// A kept energy: the largest of its changes in units of max(|E₀|, |V| + |E − V|) where they were found, and where it
  /// was farthest away; 0 where none is kept.
  struct Energy {
    double off = 0, before = 0, now = 0;
  };
  const Energy& energy() const { return found_; }
  /// The largest rate of damping |γs|, where the action makes it.
  double damping() const { return damping_; }
  /// What was looked at after the start, in the order of time: what the motion needs of it.
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
    constexpr std::size_t copies = 2;  // those of what they are held against stand beside them
    held_.add(copies * moving * sizeof(double));
    states_.push_back({x.t, StateNumbers(x.numbers.begin(), x.numbers.begin() + std::ptrdiff_t(moving))});
  }

  bool looks_;  ///< for an energy that is kept, for a damping that steps of equal length may not resolve, or to keep
  bool keeps_, started_ = false;
  std::int64_t stride_, begun_;  ///< at first, and never longer before that step
  std::int64_t seen_ = 0, early_ = 0;
  std::vector<RunState> states_;
  Held held_ = HeldByThread::take(0);  ///< for the states
  double level_ = 0, damping_ = 0;
  Energy found_;
};

}  // namespace least
