// Plain takes steps by Boost.Odeint's schemes with error control and without dense output, and more careful steps where
// their error estimates cannot be trusted.
#pragma once

#include <algorithm>
#include <boost/numeric/odeint/integrate/max_step_checker.hpp>
#include <boost/numeric/odeint/stepper/controlled_step_result.hpp>
#include <boost/numeric/odeint/util/odeint_error.hpp>

namespace least::odeint {

namespace library = boost::numeric::odeint;

/// Plain gives a controlled stepper the interface of Odeint's dense-output steppers. The rate at the end of a step
/// serves at the start of the next one. `Check` examines steps again that the stepper's own estimate accepts. Where
/// that estimate cannot be trusted (`rough`, `stiff`), the stepper `careful` takes over.
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
        if (!(h_ < tried)) {  // an error that is NaN does not shorten the step
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
  /// Whether a trial of the last step gave values that are not finite.
  bool met_undefined() const { return undefined_; }

 private:
  /// Whether a step is far shorter than earlier steps, or than it was first tried, because it crosses something sharp.
  /// Over a pole the estimated error changes its sign with the length of the step, so that some length passes by
  /// chance: after a refusal, a rough step is believed only if a shorter one passes, too, which is then taken.
  bool rough(double h, double first) const {
    constexpr double share = 0.05, refused = 0.1;
    return h < share * longest_ || h < refused * first;
  }
  /// Whether one step in three goes on being refused: then fast decaying components, not the motion, keep steps short.
  bool stiff() const {
    constexpr double many = 50;
    return refusals_ > many;
  }
  static constexpr double refused_in_smooth_motion = 0.35;

  Stepper stepper_, careful_;
  Check check_;
  Vector y_{}, rate_{}, next_{};
  double t_ = 0, h_ = 0;
  double longest_ = 0;   ///< longest step so far
  double refusals_ = 0;  ///< refused steps, beyond those of a smooth motion
  bool rated_ = false, undefined_ = false;
};

}  // namespace least::odeint
