// A motion and its derivative in one direction of the start, by the classical Runge–Kutta scheme with steps halved for
// comparison (Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, II.4).
#pragma once

#include <utility>

#include "core/run/backend.hpp"
#include "core/run/steep_steps.hpp"

namespace least {

/// Follows a motion and its derivative in one direction of the start.
class Differences {
 public:
  /// `direction`: of the component in which the start differs. `tolerance`: of a step, relative to the largest
  /// component of the state and of the derivative.
  Differences(const RunBackend& backend, const RunState& x, std::size_t direction, double end, double tolerance);

  const RunState& state() const { return here_.x; }
  const StateNumbers& derivative() const { return here_.slopes; }
  double time() const { return here_.x.t; }
  double growth() const;
  /// Whether the last trial came to a place outside of the domain.
  bool left_domain() const { return left_domain_; }

  /// One step that is accurate enough. False: the motion ends here.
  bool advance();

 private:
  /// A state and its derivative.
  struct Point {
    RunState x;
    StateNumbers slopes;
  };
  void move(Point& point, double h) const;
  bool inside(const Point& point) const;
  static std::pair<double, double> largest(const Point& point);

  const RunBackend& backend_;
  SteepSteps steep_;
  Point here_;
  double end_, scale_, tolerance_, step_;
  bool left_domain_ = false;
};

}  // namespace least
