// The length of a tangent vector in a norm that does not depend on units: coordinates and velocities, each divided by
// the extent of the motion. Momenta would do only where masses are similar: two planets with momenta of a millionth of
// their star's units would seem to separate without end. The extents are those of the true motion, as far as a few
// steps of Dormand–Prince follow it from the start, so they are the same for every scheme and do not change along a
// run. Variables of one kind, as x[1], x[2] …, share the largest extent: a variable still at rest at the far end of a
// chain has a small extent of its own, and relative to it a wave that arrives there would seem to grow without end.
#pragma once

#include <span>
#include <vector>

#include "core/run/backend.hpp"
#include "core/run/mechanics.hpp"

namespace least {

class TangentLength {
 public:
  /// Measures the motion from x until `end`, or as far as a few steps go, while keep_going(). `kinds` is kinds_of the
  /// card.
  TangentLength(const RunBackend& backend, const RunState& x, double end, std::span<const std::size_t> kinds,
                const KeepGoing& keep_going);

  double operator()(StateView x, const double* u) const;
  /// A tangent of length 1 at the start in a generic direction: no component of the scene is 0, and no two are equal.
  const StateNumbers& first() const { return first_; }

 private:
  StateNumbers velocity_slopes(StateView x, const double* u) const;
  std::vector<double> inverse_masses(StateView x, const KeepGoing& keep_going) const;
  bool has_kinetic_matrix(const RunState& x, const KeepGoing& keep_going) const;
  StateNumbers as_measured(StateView x, const double* u) const;
  void measure(RunState x, double end, std::span<const std::size_t> kinds, const KeepGoing& keep_going);
  void share(std::size_t begin, std::size_t end, const StateNumbers& largest);
  StateNumbers direction(StateView x, const KeepGoing& keep_going) const;

  const RunBackend& backend_;
  bool flow_;
  std::size_t size_, n_;  ///< number of components, and of coordinates among them
  bool by_velocities_ = false;
  StateNumbers extent_, first_;
};

}  // namespace least
