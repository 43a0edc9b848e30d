// Derivatives of event times, and the effect of events that act on the derivatives of a motion. At a zero of g(x, t; θ)
// along x(t; θ), ∂t/∂θ = −(g_x ∂x/∂θ + g_θ)/(g_x f + g_t). Where the event sets x to r(x, t; θ), the derivative becomes
// r_x ∂x/∂θ + r_θ + (r_x f + r_t − f₊) ∂t/∂θ, f₊ being the rates after the event (saltation). Second derivatives follow
// by expanding to second order: the event takes place at t + τ, τ determined by g, where the state is x + f τ + ½ ẍ τ²;
// the event makes r of it, and led back to the time t this is r − f₊ τ + ½ ẍ₊ τ². Source: Leine, Nijmeijer, Dynamics
// and Bifurcations of Non-Smooth Mechanical Systems, 2004, chapter 7.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/run/request.hpp"
#include "core/tape/formula.hpp"
#include "core/variations/parametric.hpp"
#include "core/variations/varied_motion.hpp"

namespace least::variations {

/// EventSlopes evaluates these formulas for the events of one request. States and slopes have the components of the
/// ParametricScene; events are given by their number in the request.
class EventSlopes {
 public:
  /// The request must outlive the EventSlopes. An event whose expressions read anything but components of the state has
  /// no slopes (NaN).
  EventSlopes(const Request& request, std::shared_ptr<const ParametricScene> equations);

  /// time_slope returns ∂t/∂θ of a zero along a direction, in the time of the run; `slope` is ∂x/∂θ at fixed t. NaN
  /// where there is none.
  double time_slope(std::size_t event, double t, std::span<const double> state, std::span<const double> slope,
                    const Direction& direction) const;
  /// missing returns the time from t to a zero of the event along the motion, to first order.
  double missing(std::size_t event, double t, std::span<const double> state) const;
  /// rates returns ẋ.
  std::vector<double> rates(double t, std::span<const double> state) const;

  bool acts(std::size_t event) const { return acts_[event].has_value(); }
  /// state_after returns the state that an acting event makes of this one; slope_after returns its derivative along a
  /// direction.
  std::vector<double> state_after(std::size_t event, double t, std::span<const double> state) const;
  std::vector<double> slope_after(std::size_t event, double t, std::span<const double> state,
                                  std::span<const double> slope, const Direction& direction) const;
  /// DirectedSlope is a direction and the derivative of the state along it.
  struct DirectedSlope {
    std::span<const double> slope;
    const Direction& direction;
  };
  /// second_at returns ∂²x/∂a∂b of the state at the event, whose time depends on a and b. `second` is ∂²x/∂a∂b at fixed
  /// t; a and b carry the first derivatives at fixed t.
  std::vector<double> second_at(std::size_t event, double t, std::span<const double> state, const DirectedSlope& a,
                                const DirectedSlope& b, std::span<const double> second) const;
  /// second_after returns the same for the state that the event makes; `led_back`: at the fixed time t instead of the
  /// event's time.
  std::vector<double> second_after(std::size_t event, double t, std::span<const double> state, const DirectedSlope& a,
                                   const DirectedSlope& b, std::span<const double> second, bool led_back) const;

 private:
  using Second = Dual<Slope, 1>;  ///< slopes along a, along b, and along both
  /// along returns the values of a formula and their slopes along a direction, with dt the change of the time.
  std::vector<Slope> along(const tape::Formula& formula, double t, std::span<const double> state,
                           std::span<const double> slope, const Direction& direction, double dt) const;
  std::vector<Slope> with_parameters(std::span<const double> state) const;
  std::vector<Second> along_both(const tape::Formula& formula, const Second& t, std::vector<Second> x,
                                 const Direction& a, const Direction& b) const;
  /// rates_of_rates returns ẍ.
  std::vector<double> rates_of_rates(double t, std::span<const double> state) const;
  /// Meeting is an event near the time t: its delay τ, and the state then.
  struct Meeting {
    Second later;
    std::vector<Second> state;
  };
  Meeting meeting(std::size_t event, double t, std::span<const double> state, const DirectedSlope& a,
                  const DirectedSlope& b, std::span<const double> second) const;

  std::shared_ptr<const ParametricScene> equations_;
  tape::Formula rates_, watched_;
  std::vector<std::optional<tape::Formula>> acts_;  ///< by event: all components after it; none where it does not act
};

}  // namespace least::variations
