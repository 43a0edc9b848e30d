// The true motion of a problem from a state and one tangent to it: steps as long as their Taylor series allow, each
// seen at several times on its way. The tangent has as many digits as the motion, however far it grows or shrinks: on
// an eccentric orbit its growth comes from a component that is smaller than the tangent by a factor of the tangent
// itself.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/problem_traits.hpp"
#include "core/run/tangent_motion.hpp"

namespace least {

template <class P>
class TangentPath {
 public:
  using X = StateOf<P>;
  using Direction = Vec<X::size>;

  /// `size`: of the states' largest component, about, which the tolerance of small states is relative to.
  TangentPath(const P& problem, double tolerance, double size)
      : motion_(motion_of(problem, tolerance * std::clamp(size, 1e-30, 1.0))) {}

  void start(const P& problem, const X& x, const Direction& u) {
    std::array<double, components> y, tangent;
    auto moved = convert<Slope, double>(x);
    for (std::size_t i = 0; i < X::size; ++i) moved[i].slope[0] = u[i];
    const auto values = taylor::values_of(problem, moved);  // velocities that are found by iteration have tangents, too
    for (std::size_t i = 0; i < components; ++i) {
      y[i] = values[i].value;
      tangent[i] = values[i].slope[0];
    }
    motion_.start(y, tangent, x.t);
    longest_ = 0;
    plan();
  }
  /// The time that the last step came to; and the one that the next may go to, the same where there is none.
  double time() const { return motion_.time(); }
  double reach() const { return reach_; }

  /// A step, to `end` at most. see(): called at times on the way, the last of them where the step ends; of a step that
  /// has to be taken again, being shorter, once more. False: the motion does not go on.
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

  /// The same, seen only where it ends.
  bool leap(double end) {
    const double from = time();
    for (double to = std::min(reach_, end); possible(from, to); to = from + (to - from) / 2) {
      if (!look(to) || !motion_.move(to)) continue;
      arrive(to - from);
      return true;
    }
    return false;
  }
  /// Looks at a time within the next step. False: it is not finite there.
  bool look(double t) {
    t_ = t;
    return motion_.look(t - time());
  }

  /// What is seen: the motion, and the tangent but for a factor 2ⁿ.
  X state() const {
    X x;
    x.t = t_;
    for (std::size_t i = 0; i < X::size; ++i) x[i] = motion_.state()[i];
    return x;
  }
  Direction tangent() const {
    Direction u;
    std::copy_n(motion_.tangent(0).begin(), X::size, u.begin());
    return u;
  }
  int exponent() const { return motion_.exponent(0); }
  const TangentMotion& motion() const { return motion_; }

 private:
  static constexpr std::size_t components = X::size + taylor::found<P>;
  static constexpr int parts = 4;

  static TangentMotion motion_of(const P& problem, double tolerance) {
    tape::Tape tape;
    const auto rates = taylor::write_equations<X>(problem, tape);
    return {std::move(tape), rates, 1, tolerance};
  }
  /// Of a motion that ends steps become ever shorter.
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

  TangentMotion motion_;
  double t_ = 0, reach_ = 0, longest_ = 0;
};

}  // namespace least
