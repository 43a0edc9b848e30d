// How the times of events change with what a motion depends on, and what events that act make of its derivatives. At a
// zero of g(x, t; θ) along x(t; θ), ∂t/∂θ = −(g_x ∂x/∂θ + g_θ)/(g_x f + g_t); where the event sets x to r(x, t; θ), the
// derivative becomes r_x ∂x/∂θ + r_θ + (r_x f + r_t − f₊) ∂t/∂θ, f₊ being the rates after it (saltation). Second
// derivatives are those of what this comes from, to second order: at the time t + τ of the event, which follows from g,
// the state is x + f τ + ½ ẍ τ², the event makes r of it, and led back to t it is r − f₊ τ + ½ ẍ₊ τ². Source: Leine,
// Nijmeijer, Dynamics and Bifurcations of Non-Smooth Mechanical Systems, 2004, chapter 7.
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

class EventSlopes {
 public:
  /// Of the events of a request; it outlives what is made. Expressions that read what is no component of the state have
  /// no slopes.
  EventSlopes(const Request& request, std::shared_ptr<const ParametricScene> equations);

  /// ∂t/∂θ along a direction of a zero of one of them, in the time of the run; NaN where there is none.
  double time_slope(std::size_t event, double t, std::span<const double> state, std::span<const double> slope,
                    const Direction& direction) const;
  /// How far from t a zero of it lies along the motion, to first order.
  double missing(std::size_t event, double t, std::span<const double> state) const;
  /// ẋ
  std::vector<double> rates(double t, std::span<const double> state) const;

  bool acts(std::size_t event) const { return acts_[event].has_value(); }
  /// The state that one of them makes of this one, and a derivative of it.
  std::vector<double> state_after(std::size_t event, double t, std::span<const double> state) const;
  std::vector<double> slope_after(std::size_t event, double t, std::span<const double> state,
                                  std::span<const double> slope, const Direction& direction) const;
  struct DirectedSlope {
    std::span<const double> slope;
    const Direction& direction;
  };
  /// The second derivative by two directions of the state at the event, whose time changes, too, from the one of the
  /// state at the time t (`second`) and the first derivatives of that along both directions.
  std::vector<double> second_at(std::size_t event, double t, std::span<const double> state, const DirectedSlope& a,
                                const DirectedSlope& b, std::span<const double> second) const;
  /// The same of the state that the event makes; `led_back`: to the time t.
  std::vector<double> second_after(std::size_t event, double t, std::span<const double> state, const DirectedSlope& a,
                                   const DirectedSlope& b, std::span<const double> second, bool led_back) const;

 private:
  using Second = Dual<Slope, 1>;  ///< with slopes along a, along b, and along both
  /// The values of a formula and their slopes, where the state, a parameter and the time move.
  std::vector<Slope> along(const tape::Formula& formula, double t, std::span<const double> state,
                           std::span<const double> slope, const Direction& direction, double dt) const;
  std::vector<Slope> with_parameters(std::span<const double> state) const;
  std::vector<Second> along_both(const tape::Formula& formula, const Second& t, std::vector<Second> x,
                                 const Direction& a, const Direction& b) const;
  /// ẍ
  std::vector<double> rates_of_rates(double t, std::span<const double> state) const;
  /// An event beside the time t: how much later it is, and the state then.
  struct Meeting {
    Second later;
    std::vector<Second> state;
  };
  Meeting meeting(std::size_t event, double t, std::span<const double> state, const DirectedSlope& a,
                  const DirectedSlope& b, std::span<const double> second) const;

  std::shared_ptr<const ParametricScene> equations_;
  tape::Formula rates_, watched_;
  std::vector<std::optional<tape::Formula>> acts_;  ///< of each event: all components after it
};

}  // namespace least::variations
