// How large the true motion of a scene becomes with time, from a fine run of an adaptive scheme: a run may grow as much
// as the motion does.
#pragma once

#include <atomic>
#include <cstddef>
#include <vector>

#include "core/run/request.hpp"

namespace least {

/// TrueGrowth answers such questions and extends its run as needed.
class TrueGrowth {
 public:
  /// `variables` is the number of variables of the motion. Nothing is run before the first question.
  TrueGrowth(const Request& scene, std::size_t variables, const std::atomic<bool>& cancelled);

  /// size(t) returns the largest |x_i| from the start up to t. Where the motion cannot be known, the last known value.
  double size(double t);
  /// time_of_growth returns the first time, at most `end`, at which the motion is `times` as large as up to the time
  /// `first`; else `end`.
  double time_of_growth(double times, double first, double end);

 private:
  void follow(double end);

  Request request_;
  const std::atomic<bool>& cancelled_;
  double known_until_;
  bool goes_on_ = true;
  std::vector<double> times_, sizes_;  ///< sizes_ is non-decreasing
};

}  // namespace least
