// A run, and then the sensitivities of its states.
#pragma once

#include <atomic>
#include <chrono>
#include <vector>

#include "core/variations/sensitivities.hpp"

namespace least::variations {

class VariedRun {
 public:
  VariedRun(Request request, std::shared_ptr<const SensitivitiesAsked> asked);

  /// The run itself, as it is without sensitivities to the last bit.
  Solution go(RowSink& sink, const std::atomic<bool>& cancelled);
  /// Afterwards, of what it left behind, within what is left of its seconds.
  Sensitivities sensitivities(const Solution& outcome, const std::atomic<bool>& cancelled) const;

 private:
  using Clock = std::chrono::steady_clock;

  Request request_;
  std::shared_ptr<const SensitivitiesAsked> asked_;
  Clock::time_point began_ = Clock::now();
  std::vector<double> times_;  ///< of the samples, where these are asked for
};

}  // namespace least::variations
