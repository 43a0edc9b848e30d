// A motion and its derivative with respect to one component of the start, by the classical Runge–Kutta scheme with
// steps halved for comparison (Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, II.4). Where a force
// is not differentiable, as √|x| at x = 0, no step of the variational equations is accurate: from there on the
// derivative is computed as the difference to a neighbouring motion.
#pragma once

#include <utility>

#include "core/run/backend.hpp"
#include "core/run/steep_steps.hpp"

namespace least {

/// Differences follows a motion and its derivative with respect to one component of the start.
class Differences {
 public:
  /// `direction` is the index of that component. `tolerance` is that of a step, relative to the largest component of
  /// the state and of the derivative.
  Differences(const RunBackend& backend, const RunState& x, std::size_t direction, double end, double tolerance);

  const RunState& state() const { return here_.x; }
  const StateNumbers& derivative() const { return here_.slopes; }
  double time() const { return here_.x.t; }
  double growth() const;
  /// Whether the last trial step ended outside the domain.
  bool left_domain() const { return left_domain_; }

  /// Whether the derivative can no longer be followed, although the motion goes on.
  bool lost() const { return lost_; }

  /// Takes one step within the tolerance. False: the motion ends here, or the derivative is lost.
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
  StateNumbers sizes_;  ///< largest size of each component so far
  double apart_ = 0;    ///< the neighbour is state + apart_·derivative; 0: there is none
  bool left_domain_ = false, lost_ = false;
};

}  // namespace least
