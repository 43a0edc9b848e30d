// Runs beside a run, whose differences are what derivatives are held against.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <variant>
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
  /// That by one quantity, of changes of this length, and the final state where it changes by so much.
  std::vector<double> difference(const Quantity& quantity, double length, const KeepGoing& keep_going) const;
  std::vector<double> moved(const Quantity& quantity, double by, const KeepGoing& keep_going) const;

 private:
  std::optional<std::vector<double>> nearest(const Quantity& by, std::span<const double> found, double largest,
                                             const KeepGoing& keep_going) const;

  Request request_;
  const SensitivitiesAsked& asked_;
  const Start& start_;
};

/// Why there are no derivatives where keep_going() has said so.
inline constexpr const char* no_time = "the time that the request has was over before they were found";

/// The same run along the motion, by the scheme that follows it most closely, to where it came.
Request closely(const Request& request, const Solution& outcome);
/// What that run comes to: it ends early where keep_going() says so.
Solution run_of_motion(const Request& request, const Solution& outcome, const KeepGoing& keep_going);

/// A motion at some time, and its slopes by what was asked for.
struct Beginning {
  double t;
  std::vector<double> state;
  std::vector<std::vector<double>> slopes;
};
/// Where the equations are singular at the start, runs leave it along the one motion that is regular there: from the
/// time t, shortly after, derivatives of it can be followed. It depends on parameters alone, and so smoothly that
/// differences of runs up to there have all digits. Else why not.
std::variant<Beginning, std::string> beyond_singular_start(const Request& request, const Solution& outcome,
                                                           const SensitivitiesAsked& asked, const Start& start,
                                                           double t, const KeepGoing& keep_going);

}  // namespace least::variations
