// Whole states along a run, for the diagnostics that need them.
#pragma once

#include <cstdint>
#include <vector>

#include "core/memory_budget.hpp"
#include "core/run/integrator.hpp"

namespace least {

/// Snapshots keeps the state at every stride-th step and doubles the stride whenever there are too many states, so that
/// it needs no plan of how long the run will be.
class Snapshots {
 public:
  void see(const IntegrationState& state) {
    if (state.n % stride_ != 0) return;
    constexpr std::size_t copies = 4;  // the states, those that they are compared with, and sizes there
    const std::size_t bytes = copies * state.x.size() * sizeof(double);
    held_.add(bytes);
    states_.push_back(state.x);
    if (states_.size() <= most) return;
    for (std::size_t i = 0; 2 * i < states_.size(); ++i) states_[i] = states_[2 * i];
    states_.resize((states_.size() + 1) / 2);
    held_.shrink_to(states_.size() * bytes);
    stride_ *= 2;
  }
  /// The next step after n whose state is kept.
  std::int64_t next(std::int64_t n) const { return (n / stride_ + 1) * stride_; }
  const std::vector<RunState>& states() const { return states_; }

 private:
  static constexpr std::size_t most = 256;
  std::int64_t stride_ = 1;
  std::vector<RunState> states_;
  Held held_ = HeldByThread::take(0);  ///< memory of the states
};

}  // namespace least
