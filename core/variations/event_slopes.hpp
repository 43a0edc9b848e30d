// How the times of events change with what a motion depends on: at a zero of g(x, t; θ) along x(t; θ),
// ∂t/∂θ = −(g_x ∂x/∂θ + g_θ)/(g_x f + g_t).
#pragma once

#include <span>
#include <vector>

#include "core/run/measures.hpp"
#include "core/tape/formula.hpp"
#include "core/variations/parametric.hpp"
#include "core/variations/varied_motion.hpp"

namespace least::variations {

class EventSlopes {
 public:
  /// `watched`: expressions over the scene. Those that read what is no component of the state have no slopes.
  EventSlopes(const Scene& scene, std::shared_ptr<const ParametricScene> equations, const Measures& watched);

  /// ∂t/∂θ along a direction of a zero of one of them, in the time of the run; NaN where there is none.
  double operator()(std::size_t event, double t, std::span<const double> state, std::span<const double> slope,
                    const Direction& direction) const;
  /// ẋ
  std::vector<double> rates(double t, std::span<const double> state) const;

 private:
  std::vector<double> with_parameters(std::span<const double> state) const;

  std::shared_ptr<const ParametricScene> equations_;
  tape::Formula rates_, watched_;
};

}  // namespace least::variations
