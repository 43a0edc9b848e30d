// Steps of Boost.Odeint's schemes that have error control and no dense output, where they can be trusted, and careful
// ones where they cannot.
#pragma once

#include <algorithm>
#include <boost/numeric/odeint/integrate/max_step_checker.hpp>
#include <boost/numeric/odeint/stepper/controlled_step_result.hpp>
#include <boost/numeric/odeint/util/odeint_error.hpp>

namespace least::odeint {

namespace library = boost::numeric::odeint;

/// A stepper with error control and no dense output, with the calls of those that have it. The rate at the end of a
/// step is the next one's. `Check` has a second look at the steps that the stepper's own estimate accepts. Where that
/// estimate is not to be trusted another stepper takes over, a careful one: see `rough` and `stiff`.
template <class Stepper, class Check, class Vector>
class Plain {
 public:
  Plain(const Check& check, const Stepper& stepper, const Stepper& careful)
      : stepper_(stepper), careful_(careful), check_(check) {}

  void initialize(const Vector& y, double t, double h) {
    y_ = rate_ = next_ = y;
    t_ = t;
    h_ = h;
    rated_ = false;
  }
  template <class System>
  void do_step(System system) {
    if (!rated_) system(y_, rate_, t_);
    rated_ = true;
    const double before = t_, first = h_;
    bool refused = false, confirmed = true;
    undefined_ = false;
    library::failed_step_checker check;
    for (;; check()) {
      check_.begin(rate_);
      const auto seen = [&](const Vector& x, Vector& dx, double time) {
        system(x, dx, time);
        check_.see(dx);
      };
      const double tried = h_;
      Stepper& stepper = rough(tried, first) || stiff() ? careful_ : stepper_;
      if (stepper.try_step(seen, y_, rate_, t_, next_, h_) == library::fail) {
        if (!(h_ < tried)) {  // an error that is no number shortens nothing
          h_ = 0.2 * tried;
          undefined_ = true;
        }
        if (!(before + h_ > before)) throw library::step_adjustment_error("a step is too short to advance the time");
        refused = true;
        confirmed = false;
        continue;
      }
      const double h = t_ - before, longest = check_.longest(y_, rate_, h, rough(h, first));
      const bool passes = !(before + longest < t_);
      if (passes && (confirmed || !rough(h, first))) {
        h_ = std::min(h_, longest);
        longest_ = std::max(longest_, h);
        break;
      }
      constexpr double shorter = 0.7;
      h_ = passes ? shorter * h : std::min(h_, longest);
      confirmed = passes;
      t_ = before;
    }
    refusals_ = std::max(refusals_ + (refused ? 1 : -refused_in_smooth_motion), 0.0);
    y_ = next_;
    system(y_, rate_, t_);
  }
  const Vector& current_state() const { return y_; }
  double current_time() const { return t_; }
  double current_time_step() const { return h_; }
  /// Whether a trial of the last step came to what is not finite.
  bool met_undefined() const { return undefined_; }

 private:
  /// A step far shorter than others were, or than it was to be, crosses something sharp. Over a pole the error, as an
  /// estimate sees it, changes its sign with the length of the step, so that one passes by chance: after one that was
  /// refused it is believed where a shorter one passes, too, and that one is taken.
  bool rough(double h, double first) const {
    constexpr double share = 0.05, refused = 0.1;
    return h < share * longest_ || h < refused * first;
  }
  /// Steps that go on being refused, one in three, are kept short by what the motion damps and not by what it does.
  bool stiff() const {
    constexpr double many = 50;
    return refusals_ > many;
  }
  static constexpr double refused_in_smooth_motion = 0.35;

  Stepper stepper_, careful_;
  Check check_;
  Vector y_{}, rate_{}, next_{};
  double t_ = 0, h_ = 0;
  double longest_ = 0;   ///< of the steps until now
  double refusals_ = 0;  ///< of steps, beyond those of a smooth motion
  bool rated_ = false, undefined_ = false;
};

}  // namespace least::odeint
