// The true motion of a problem from a state, with one tangent vector: steps as long as the Taylor series allow, each
// looked at several times on its way. The tangent has as many digits as the motion, however far it grows or shrinks: on
// an eccentric orbit its growth comes from a component that is smaller than the tangent by a factor as large as the
// tangent.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "core/run/backend.hpp"
#include "core/run/tangent_motion.hpp"

namespace least {

class TangentPath {
 public:
  /// `size`: about the largest component of the states; the tolerance is relative to it if it is below 1.
  TangentPath(const RunBackend& backend, double tolerance, double size);

  void start(StateView x, const double* u);
  /// time() is the end of the last step, reach() the farthest end of the next step, the same where there is none.
  double time() const { return motion_.time(); }
  double reach() const { return reach_; }

  /// advance takes a step, to `end` at most. It calls see() at times on the way, the last of them at the end of the
  /// step; where a step has to be repeated shorter, see() is called again. False: the motion does not go on.
  template <class See>
  bool advance(double end, See&& see) {
    const double from = time();
    for (double to = std::min(reach_, end); possible(from, to); to = from + (to - from) / (2 * parts)) {
      int part = 1;
      for (; part <= parts; ++part) {
        if (!look(part < parts ? from + (to - from) * part / parts : to)) break;
        see();
      }
      if (part <= parts || !motion_.move(to)) continue;
      arrive(to - from);
      return true;
    }
    return false;
  }

  /// The same without looks on the way.
  bool leap(double end) {
    const double from = time();
    for (double to = std::min(reach_, end); possible(from, to); to = from + (to - from) / 2) {
      if (!look(to) || !motion_.move(to)) continue;
      arrive(to - from);
      return true;
    }
    return false;
  }
  /// Evaluates the motion at a time within the next step. False: it is not finite there.
  bool look(double t) {
    t_ = t;
    return motion_.look(t - time());
  }

  /// The motion at the time last looked at, and the tangent without its factor 2ⁿ, n = exponent().
  RunState state() const { return {t_, first_of(motion_.state())}; }
  StateNumbers tangent() const { return first_of(motion_.tangent(0)); }
  int exponent() const { return motion_.exponent(0); }
  const TangentMotion& motion() const { return motion_; }

 private:
  static constexpr int parts = 4;

  StateNumbers first_of(std::span<const double> numbers) const {
    return {numbers.data(), numbers.data() + components_};
  }
  /// Whether a step is long enough to make progress: near the end of a motion steps become ever shorter.
  bool possible(double from, double to) const { return to - from > 1e-13 * std::max(std::abs(from), longest_); }
  void arrive(double step) {
    longest_ = std::max(longest_, step);
    plan();
  }
  void plan() {
    t_ = time();
    reach_ = t_ + motion_.step();
    if (!possible(t_, reach_)) reach_ = t_;
  }

  const RunBackend& backend_;
  std::size_t components_;  ///< number of components of a state
  TangentMotion motion_;
  std::vector<double> values_, slopes_;
  double t_ = 0, reach_ = 0, longest_ = 0;
};

}  // namespace least
