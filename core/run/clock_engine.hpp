// A scheme that sets its own clock, bound to a problem and erased: called once per block of steps.
#pragma once

#include <optional>
#include <string>

#include "core/run/dense.hpp"
#include "core/run/observer.hpp"
#include "core/run/structure.hpp"
#include "core/run/wording.hpp"
#include "core/scheme.hpp"

namespace least {

/// What a block of steps met on its way.
struct ClockMet {
  double turn_squared = 0;  ///< the largest (ωh)² of the steps in time, where the problem estimates ω
  double turn_limit = std::numeric_limits<double>::infinity();  ///< where a block ends because of it
  bool unsound = false, left = false;  ///< a state that is not finite came up, time stood still; the domain was left
};

template <class P, class X>
class ClockEngine {
 public:
  virtual ~ClockEngine() = default;
  /// Takes steps until one reaches the time `until`, there are `count` of them, one is taken in another way than the
  /// one before it, or something is met; the place is the last good one. The observer, where there is one, sees states
  /// no later than `end`.
  virtual Status advance(Place<X>& place, double until, double end, std::int64_t count, ClockMet& met,
                         Observer<P, X>* observer) = 0;
  /// Goes on from x, which came from `before` by other means than a step.
  virtual void begin(const X& before, const X& x) = 0;
  /// A step from x that ends at the time t, on a copy, where the scheme can take one.
  virtual Status leap(X& x, double t) const = 0;
  /// The state before the last step.
  virtual const X& before() const = 0;
  /// The state at a time within the last step, which ended in x. Part of the work only where `counted`.
  virtual Status between(X& x, double t, bool counted) = 0;
  /// How the last step was taken; empty where there is but one way.
  virtual std::optional<Course> course() const = 0;
  /// Steps that had to be taken in another way than the scheme's.
  virtual std::int64_t rescues() const = 0;
  /// What of the energy says that the run has gone wrong, in words; empty: nothing.
  virtual std::string complaint() const = 0;
  virtual Work work() const = 0;
  /// What the scheme has against this scene, in words; empty: nothing.
  virtual std::string objection() const = 0;
  /// Derivatives of a step from x by its state, on the run's energy level; empty where the step fails, or where steps
  /// remember more than the state.
  virtual std::optional<Tangent<FullStateOf<P>>> tangent(const FullStateOf<P>& x) const = 0;
};

template <class P, class Scheme, class X>
class ClockBound final : public ClockEngine<P, X> {
 public:
  using Stepper = ClockStepperOf<Scheme, P, X>;
  static constexpr bool hybrid = requires(const Stepper& s) { s.course(); };

  ClockBound(const P& problem, const Scheme& scheme, const X& x)
      : problem_(problem),
        scheme_(scheme),
        energy_(level(problem, x)),
        stepper_(scheme.bind(problem, x, energy_)),
        before_(x) {}

  Status advance(Place<X>& place, double until, double end, std::int64_t count, ClockMet& met,
                 Observer<P, X>* observer) override {
    auto stepper = stepper_;
    X x = place.x, before = before_;
    double late = late_;
    Status status = Status::ok;
    std::int64_t n = place.n;
    const std::int64_t last = n + count;
    const Course course = course_of(stepper);
    [[maybe_unused]] double last_frequency = 0;
    if constexpr (hybrid && HasFrequency<P>) last_frequency = problem_.frequency_squared(x.q);
    while (n < last && x.t < until) {
      X y = x;
      if (!reads_time) y.t = 0;  // the step says how long it took, and the sum is compensated
      status = stepper.step(y);
      if (status != Status::ok) break;
      const double h = reads_time ? y.t - x.t : y.t, part = h - late, t = reads_time ? y.t : x.t + part;
      double size = 0;
      for (std::size_t i = 0; i < X::size; ++i) size += value_of(y[i]) * value_of(y[i]);
      met.unsound = !(size < largest_square) || !(h > 0) || !std::isfinite(t);
      if (met.unsound) break;
      if constexpr (HasDomain<P>) met.left = problem_.bounded() && !(problem_.inside(position(y)) >= 0);
      if constexpr (HasDomain<P>)
        if (met.left) break;
      if constexpr (hybrid && HasFrequency<P>) {  // steps in time, at either end of which the motion may be too fast
        const double frequency = problem_.frequency_squared(y.q);
        const bool in_time = stepper.course().mode == Mode::hamilton || stepper.course().parameter < 0;
        const double turn = (frequency > last_frequency ? frequency : last_frequency) * h * h;
        last_frequency = frequency;
        if (in_time && turn > met.turn_squared) met.turn_squared = turn;
        if (met.turn_squared > met.turn_limit) break;
      }
      if (!reads_time) late = (t - x.t) - part;
      before = x;
      x = y;
      x.t = t;
      if constexpr (Sloped<X>) normalise(x);
      ++n;
      if (observer && x.t <= end) observer->see(problem_, x);
      if (course_of(stepper) != course || (observer && observer->crossed)) break;
    }
    stepper_ = stepper;
    before_ = before;
    late_ = late;
    place = {x, n};
    return status;
  }

  void begin(const X& before, const X& x) override {
    stepper_ = scheme_.bind(problem_, x, energy_);
    before_ = before;
  }
  Status leap(X& x, double t) const override {
    if constexpr (requires(Stepper s) { s.reach(x, t); }) {
      auto stepper = scheme_.bind(problem_, x, energy_);
      return stepper.reach(x, t);
    } else {
      return Status::solver_failed;
    }
  }
  const X& before() const override { return before_; }

  Status between(X& x, double t, bool counted) override {
    if (!(t < x.t)) return Status::ok;
    if constexpr (requires(const Stepper& s) { s.interpolate(x, t); })
      if (stepper_.interpolate(x, t)) return Status::ok;
    if constexpr (requires(Stepper s) { s.reach(x, t); }) {
      auto stepper = scheme_.bind(problem_, before_, energy_);
      X y = before_;
      if (!reads_time) y.t = 0;
      if (const Status status = stepper.reach(y, reads_time ? t : t - before_.t); status != Status::ok) return status;
      x = y;
      if (counted) between_ = stepper.work();
    } else {
      x = hermite(problem_, before_, x, t);
      if (counted) between_ = {4, 0};
    }
    x.t = t;
    return Status::ok;
  }

  std::optional<Course> course() const override {
    if constexpr (hybrid) return stepper_.course();
    return std::nullopt;
  }
  std::int64_t rescues() const override {
    if constexpr (requires { stepper_.rescues(); }) return stepper_.rescues();
    return 0;
  }
  std::string complaint() const override {
    constexpr double most = 0.5;
    if constexpr (requires { stepper_.strain(); }) {
      if (stepper_.strain() > most) return wording::strain(stepper_.strain());
    } else if constexpr (reads_time && Conservative<P> && Autonomous<P>) {
      const double now = energy(problem_, before_), potential = least::potential(problem_, position(before_));
      const double off = std::abs(now - energy_) / (std::abs(potential) + std::abs(now - potential));
      if (off > most) return wording::energy_jump(energy_, now);
    }
    return {};
  }
  Work work() const override {
    const Work here = stepper_.work();
    return {here.forces + between_.forces, here.iterations + between_.iterations};
  }
  std::string objection() const override {
    if constexpr (requires { scheme_.objection(problem_, energy_); }) return scheme_.objection(problem_, energy_);
    return {};
  }
  std::optional<Tangent<FullStateOf<P>>> tangent([[maybe_unused]] const FullStateOf<P>& x) const override {
    if constexpr (reads_time || requires { requires Scheme::remembers; }) {
      return std::nullopt;
    } else {
      return tangent_of(x, [&](auto& y) {
        using D = typename std::remove_cvref_t<decltype(y)>::Number;
        auto z = convert<D, D>(y);
        auto stepper = scheme_.bind(problem_, z, D(energy_));
        const Status status = stepper.step(z);
        y.t = z.t.value;
        for (std::size_t i = 0; i < X::size; ++i) y[i] = z[i];
        return status;
      });
    }
  }

 private:
  static Course course_of(const Stepper& stepper) {
    if constexpr (hybrid) return stepper.course();
    return {};
  }
  /// E₀; of a scene whose schemes do not ask for it nothing.
  static double level([[maybe_unused]] const P& problem, [[maybe_unused]] const X& x) {
    if constexpr (Conservative<P>) {
      return energy(problem, x);
    } else {
      return 0;
    }
  }
  static constexpr double largest_square = 1e150;
  static constexpr bool reads_time = requires { requires Scheme::reads_time; };

  P problem_;
  Scheme scheme_;
  double energy_;
  Stepper stepper_;
  X before_;
  double late_ = 0;  ///< what rounding has kept from the sum of the steps
  Work between_;
};

}  // namespace least
