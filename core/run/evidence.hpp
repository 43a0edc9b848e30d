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

#include "core/problem_traits.hpp"
#include "core/run/integrator.hpp"

namespace least {

template <class P, class X>
class Evidence {
 public:
  /// `steps`: how many there are to be, where that is known. `keeps`: the states that are looked at are kept.
  Evidence(std::optional<std::int64_t> steps, bool keeps)
      : keeps_(keeps),
        equal_(steps.has_value()),
        stride_(steps ? std::clamp<std::int64_t>(*steps / 16, 1, 256) : 16),
        begun_(stride_) {}

  /// The next step to be looked at after the n-th.
  std::int64_t next(std::int64_t n) const {
    if (!looks()) return std::numeric_limits<std::int64_t>::max();
    return n < begun_ ? std::min(std::max<std::int64_t>(2 * n, 1), begun_) : (n / stride_ + 1) * stride_;
  }
  void start(const P& problem, const X& x) {
    started_ = true;
    if constexpr (KeepsEnergy<P>) level_ = found_.before = found_.now = energy_of(problem, x);
    look(problem, x);
  }
  /// The state after a block.
  void see(const P& problem, const IntegrationState<X>& state) {
    const bool early = state.n < begun_ && std::has_single_bit(static_cast<std::uint64_t>(state.n));
    if (!looks() || (!early && state.n % stride_ != 0)) return;
    look(problem, state.x);
    keep(state.x);
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
    states_.resize(static_cast<std::size_t>(early_ + seen_));
  }
  void finish(const P& problem, const IntegrationState<X>& state) {
    if (!started_) return;
    look(problem, state.x);
    if (states_.empty() || states_.back().t < state.x.t) keep(state.x);
  }

  /// A kept energy: the largest of its changes in units of max(|E₀|, |V| + |E − V|) where they were found, and where it
  /// was farthest away; 0 where none is kept.
  struct Energy {
    double off = 0, before = 0, now = 0;
  };
  const Energy& energy() const { return found_; }
  /// The largest rate of damping |γs|, where the action makes it.
  double damping() const { return damping_; }
  /// What was looked at after the start, in the order of time.
  std::span<const StateOf<P>> states() const { return states_; }

 private:
  bool looks() const { return keeps_ || KeepsEnergy<P> || (QuadraticContact<P> && equal_); }
  static constexpr std::int64_t most_looks = 256;

  void look([[maybe_unused]] const P& problem, [[maybe_unused]] const X& x) {
    if constexpr (KeepsEnergy<P>) {
      const double now = value_of(least::energy(problem, x));
      double size = std::abs(now);
      if constexpr (Potential<P>) {
        const double potential = value_of(least::potential(problem, x.q));
        size = std::abs(potential) + std::abs(now - potential);
      }
      const double off = std::abs(now - level_) / std::max({std::abs(level_), size, 1e-300});
      found_.off = std::max(found_.off, off);
      if (std::abs(now - level_) > std::abs(found_.now - level_)) found_.now = now;
    }
    if constexpr (QuadraticContact<P>)
      damping_ = std::max(damping_, std::abs(value_of(x.action.s) * double(problem.action_curvature())));
  }

  void keep(const X& x) {
    if (keeps_) assign(states_.emplace_back(), plain(x));
  }

  bool keeps_, equal_, started_ = false;  ///< equal_: steps are of equal length, which a damping may be too strong for
  std::int64_t stride_, begun_;           ///< at first, and never longer before that step
  std::int64_t seen_ = 0, early_ = 0;
  std::vector<StateOf<P>> states_;
  double level_ = 0, damping_ = 0;
  Energy found_;
};

}  // namespace least
