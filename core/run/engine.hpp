// A scheme bound to a problem, erased: called once per block of steps, so that what a run does around its steps is
// compiled once per problem and not once per pair.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/run/observer.hpp"
#include "core/run/schedule.hpp"
#include "core/run/structure.hpp"
#include "core/scheme.hpp"

namespace least {

/// What a block of steps met on its way.
struct Met {
  double frequency = 0;  ///< the largest squared local frequency, where the problem estimates one
  double pull = 0;  ///< the largest −γ s h, where H has γs²/2: from 2 on a step reaches the pole of ṡ = −γs²/2
  bool left = false;  ///< the domain was left
};

template <class P, class X>
class Engine {
 public:
  virtual ~Engine() = default;
  /// Takes `count` whole steps; the clock is grid.time(n). Returns early where a step fails, the place being the last
  /// good one. Looks at every step through the observer where there is one.
  virtual Status advance(Place<X>& place, const Grid& grid, std::int64_t count, Met& met, Observer<P, X>* observer) = 0;
  /// One step of any length; x.t is left to the caller.
  virtual Status step(X& x, double h) = 0;
  /// The same on a copy: leaves the run alone and is not part of its work. `saved`: from the state that was saved.
  virtual Status peek(X& x, double h, bool saved = false) const = 0;
  /// One step of any length from any state, on a copy.
  virtual Status leap(X& x, double h) const = 0;
  virtual void save() = 0;
  virtual void restore() = 0;
  /// Begins anew at x, the work done so far kept.
  virtual void rebind(const X& x) = 0;
  virtual Work work() const = 0;
  /// Whether a step may begin where the equations of motion are singular in time.
  virtual bool starts_at_singularity() const = 0;
  /// What the scheme has against this scene, in words; empty: nothing.
  virtual std::string objection() const = 0;
  /// Whether, and when first, one of the run's `steps` steps turns the momentum over where the motion only damps it:
  /// looked at over the span, not at each step.
  virtual std::optional<double> flips_momentum(const Grid& grid, std::int64_t steps) const = 0;
  /// Derivatives of a step from x by its state; empty where the step fails.
  virtual std::optional<Tangent<FullStateOf<P>>> tangent(const FullStateOf<P>& x, double h) const = 0;
};

template <class P, class Scheme, class X>
class Bound final : public Engine<P, X> {
 public:
  using Stepper = StepperOf<Scheme, P, X>;

  Bound(const P& problem, const Scheme& scheme, const X& x)
      : problem_(problem), scheme_(scheme), stepper_(scheme.bind(problem, x)), saved_(stepper_) {}

  Status advance(Place<X>& place, const Grid& grid, std::int64_t count, Met& met, Observer<P, X>* observer) override {
    return observer ? loop<true>(place, grid, count, met, observer) : loop<false>(place, grid, count, met, nullptr);
  }
  Status step(X& x, double h) override { return stepper_.step(x, h); }
  Status peek(X& x, double h, bool saved) const override {
    Stepper copy = saved ? saved_ : stepper_;
    return copy.step(x, h);
  }
  Status leap(X& x, double h) const override {
    Stepper fresh = scheme_.bind(problem_, x);
    return fresh.step(x, h);
  }
  void save() override { saved_ = stepper_; }
  void restore() override { stepper_ = saved_; }
  void rebind(const X& x) override {
    before_ = work();
    stepper_ = scheme_.bind(problem_, x);
  }
  Work work() const override {
    const Work here = stepper_.work();
    return {before_.forces + here.forces, before_.iterations + here.iterations};
  }
  bool starts_at_singularity() const override {
    if constexpr (requires { scheme_.starts_at_singularity(problem_); }) {
      return scheme_.starts_at_singularity(problem_);
    } else {
      return false;
    }
  }
  std::string objection() const override {
    if constexpr (requires { scheme_.objection(problem_); }) return scheme_.objection(problem_);
    return {};
  }
  std::optional<double> flips_momentum([[maybe_unused]] const Grid& grid,
                                       [[maybe_unused]] std::int64_t steps) const override {
    if constexpr (requires { scheme_.flips_momentum(problem_, 0.0); }) {
      constexpr std::int64_t most = 1000;
      const std::int64_t looks = std::min(steps, most);
      for (std::int64_t k = 1; k <= looks; ++k) {
        const auto n =
            static_cast<std::int64_t>(static_cast<double>(steps) * static_cast<double>(k) / static_cast<double>(looks));
        const double t = grid.time(std::max<std::int64_t>(n, 2));  // the first step may begin where damping is singular
        if (scheme_.flips_momentum(problem_, t)) return t;
      }
    }
    return std::nullopt;
  }
  std::optional<Tangent<FullStateOf<P>>> tangent(const FullStateOf<P>& x, double h) const override {
    if constexpr (Potential<P>) {
      return tangent_map(scheme_, problem_, x, h);
    } else {
      return std::nullopt;
    }
  }

 private:
  template <bool Observed>
  Status loop(Place<X>& place, const Grid& grid, std::int64_t count, Met& met, Observer<P, X>* observer) noexcept {
    auto stepper = stepper_;
    auto x = place.x;
    double most = met.frequency;
    [[maybe_unused]] bool left = met.left;
    [[maybe_unused]] double lowest = 0;  // action
    Status status = Status::ok;
    std::int64_t n = place.n;
    const std::int64_t end = n + count;
    while (n < end) {
      status = stepper.step(x, grid.step);
      if (status != Status::ok) break;
      x.t = grid.time(++n);
      if constexpr (HasFrequency<P>) {
        const double here = problem_.frequency_squared(position(x));
        most = here > most ? here : most;
      }
      if constexpr (QuadraticContact<P>) lowest = x.action.s < lowest ? x.action.s : lowest;
      if constexpr (HasDomain<P>) left = left || !(problem_.inside(position(x)) >= 0);
      if constexpr (Sloped<X>) normalise(x);
      if constexpr (Observed) observer->see(problem_, x);
    }
    stepper_ = stepper;
    place.x = x;
    place.n = n;
    met.frequency = most;
    if constexpr (QuadraticContact<P>) met.pull = std::max(met.pull, -problem_.action_curvature() * lowest * grid.step);
    if constexpr (HasDomain<P>) met.left = left && problem_.bounded();
    return status;
  }

  P problem_;
  Scheme scheme_;
  Stepper stepper_, saved_;
  Work before_;
};

}  // namespace least
