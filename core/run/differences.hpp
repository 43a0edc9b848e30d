// A motion and its derivative in one direction of the start, by the classical Runge–Kutta scheme with steps halved for
// comparison (Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, II.4). Where the force changes
// infinitely fast, as √|x| at x = 0, there is no step by its derivatives: from there on those of the motion are
// followed as its difference from a neighbour.
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

  /// Whether nothing is known of the derivative any more, although the motion goes on.
  bool lost() const { return lost_; }

  /// One step that is accurate enough. False: the motion ends here, or the derivative is lost.
  bool advance();

 private:
  /// A state and its derivative.
  struct Point {
    RunState x;
    StateNumbers slopes;
  };
  void move(Point& point, double h) const;
  void find_rates(const Point& at, double* rates, double* changes) const;
  double neighbour() const;
  bool inside(const Point& point) const;
  static std::pair<double, double> largest(const Point& point);

  const RunBackend& backend_;
  SteepSteps steep_;
  Point here_;
  double end_, scale_, tolerance_, step_;
  StateNumbers sizes_;  ///< of the components, the largest so far
  double apart_ = 0;    ///< the neighbour is the state and so many derivatives; 0: none is followed
  bool left_domain_ = false, lost_ = false;
};

}  // namespace least
