// How large the true motion of a scene becomes with time, by a fine run of a scheme that chooses its own steps: what a
// run may grow by is what the motion grows by.
#pragma once

#include <atomic>
#include <cstddef>
#include <vector>

#include "core/run/request.hpp"

namespace least {

class TrueGrowth {
 public:
  /// Of a scene whose motion has so many variables; runs no sooner than it is asked.
  TrueGrowth(const Request& scene, std::size_t variables, const std::atomic<bool>& cancelled);

  /// The largest |x_i| from the start up to the time t. Beyond what can be known it is what it was before.
  double size(double t);
  /// The first time at which the motion is `times` as large as it was up to the time `first`, if that is before `end`;
  /// else `end`.
  double time_of_growth(double times, double first, double end);

 private:
  void follow(double end);

  Request request_;
  const std::atomic<bool>& cancelled_;
  double known_until_;
  bool goes_on_ = true;
  std::vector<double> times_, sizes_;  ///< the sizes do not decrease
};

}  // namespace least
