// Runs next to a run, whose finite differences check its derivatives.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/variations/start.hpp"

namespace least::variations {

/// Neighbours repeats the run of a request with one quantity changed.
class Neighbours {
 public:
  /// `asked` and `start` must outlive the Neighbours.
  Neighbours(const Request& request, const SensitivitiesAsked& asked, const Start& start);

  /// differences returns fourth-order central differences of the final state by all quantities, direction by direction.
  /// Changes are made smaller while that brings the differences closer to `found`, the derivatives they are to confirm.
  /// NaN where a run does not reach its end; nothing where the time did not suffice.
  std::optional<std::vector<double>> differences(std::span<const double> found, const KeepGoing& keep_going) const;
  /// difference returns the central difference by one quantity with the change `length`; moved returns the final state
  /// where the quantity is changed by `by`.
  std::vector<double> difference(const Quantity& quantity, double length, const KeepGoing& keep_going) const;
  std::vector<double> moved(const Quantity& quantity, double by, const KeepGoing& keep_going) const;

 private:
  std::optional<std::vector<double>> nearest(const Quantity& by, std::span<const double> found, double largest,
                                             const KeepGoing& keep_going) const;

  Request request_;
  const SensitivitiesAsked& asked_;
  const Start& start_;
};

/// The reason for missing derivatives once keep_going() has returned false.
inline constexpr const char* no_time = "the time that the request has was over before they were found";

/// closely returns the same run with the scheme `taylor` at its smallest tolerance, to where the outcome ended.
Request closely(const Request& request, const Solution& outcome);
/// run_of_motion returns the outcome of that run; the run ends early once keep_going() returns false.
Solution run_of_motion(const Request& request, const Solution& outcome, const KeepGoing& keep_going);

/// Beginning is the motion at some time, and its derivatives by each quantity.
struct Beginning {
  double t;
  std::vector<double> state;
  std::vector<std::vector<double>> slopes;
};
/// Where the equations are singular at the start, the run begins with the one motion that is regular there.
/// beyond_singular_start returns this motion at the later time t, from where derivatives can be followed. The motion
/// depends on parameters alone, and so smoothly that differences of runs up to t have full precision. Otherwise it
/// returns why there is none.
std::variant<Beginning, std::string> beyond_singular_start(const Request& request, const Solution& outcome,
                                                           const SensitivitiesAsked& asked, const Start& start,
                                                           double t, const KeepGoing& keep_going);

}  // namespace least::variations
