// A run, followed by the derivatives of its states.
#pragma once

#include <atomic>
#include <chrono>
#include <vector>

#include "core/variations/sensitivities.hpp"

namespace least::variations {

/// VariedRun runs a request and remembers what its sensitivities need.
class VariedRun {
 public:
  VariedRun(Request request, std::shared_ptr<const SensitivitiesAsked> asked);

  /// go(…) runs the request; the rows are bitwise those of the run without sensitivities.
  Solution go(RowSink& sink, const std::atomic<bool>& cancelled);
  /// sensitivities(…) is called after go(…), with its outcome; it uses what is left of the request's seconds.
  Sensitivities sensitivities(const Solution& outcome, const std::atomic<bool>& cancelled) const;

 private:
  using Clock = std::chrono::steady_clock;

  Request request_;
  std::shared_ptr<const SensitivitiesAsked> asked_;
  Clock::time_point began_ = Clock::now();
  std::vector<double> times_;  ///< times of the samples, where derivatives at samples are asked for
};

}  // namespace least::variations
