// Runs beside a run, whose differences are what derivatives are held against.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/variations/start.hpp"

namespace least::variations {

class Neighbours {
 public:
  /// Of a request; `asked` and `start` outlive it.
  Neighbours(const Request& request, const SensitivitiesAsked& asked, const Start& start);

  /// Central differences of the fourth order of the final state by all quantities, direction by direction, of changes
  /// that are small enough to tell the derivatives `found`, which they are to confirm; not a number where a run does
  /// not come to its end. Nothing where there was no time for them, or one is by the time.
  std::optional<std::vector<double>> differences(std::span<const double> found, const KeepGoing& keep_going) const;

 private:
  std::optional<std::vector<double>> nearest(const Quantity& by, std::span<const double> found, double largest,
                                             const KeepGoing& keep_going) const;
  std::vector<double> difference(const Quantity& quantity, double length, const KeepGoing& keep_going) const;
  std::vector<double> moved(const Quantity& quantity, double by, const KeepGoing& keep_going) const;

  Request request_;
  const SensitivitiesAsked& asked_;
  const Start& start_;
};

/// The same run along the motion, by the scheme that follows it most closely, to where it came.
Request closely(const Request& request, const Solution& outcome);

}  // namespace least::variations
