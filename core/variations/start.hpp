// The start of a motion, and its derivatives by its own numbers and by parameters.
#pragma once

#include <vector>

#include "core/run/mechanics.hpp"
#include "core/tape/formula.hpp"
#include "core/variations/sensitivities.hpp"

namespace least::variations {

/// formula_of returns a formula of symbols on the scene's tape; its inputs are the components, then the parameters.
tape::Formula formula_of(const ParametricScene& scene, const std::vector<Symbol>& all);

/// Start is the start of a scene as components of the ParametricScene.
class Start {
 public:
  /// Both arguments must outlive the Start.
  Start(const Scene& scene, const SensitivitiesAsked& asked);

  const std::vector<double>& state() const { return x_; }
  /// follows_from_time() tells whether the start lies on the one regular motion out of a singularity before it, so that
  /// it is a function of start time and parameters.
  bool follows_from_time() const { return regular_; }
  /// slope(by) returns the derivative of the state by the quantity, at a fixed time of the run.
  std::vector<double> slope(const Quantity& by) const;
  /// second(a, b) returns the second derivative; not for the start time.
  std::vector<double> second(const Quantity& a, const Quantity& b) const;
  /// value(by) returns the value of a quantity. move(quantity, by, scene) changes it in a scene by `by`, with what
  /// depends on it; not the start time where follows_from_time().
  double value(const Quantity& by) const;
  void move(const Quantity& quantity, double by, Scene& scene) const;

 private:
  template <class T>
  std::vector<T> momenta_of(std::vector<T> x, const T& t) const;
  /// way_of returns the direction of change of (q, v, s, parameters).
  std::vector<double> way_of(const Quantity& by) const;
  std::vector<double> slope_in_momenta(const Quantity& by) const;
  std::vector<double> slope_in_velocities(const Quantity& by) const;

  /// regular returns the components of the scene's regular start for these parameters; empty where there is none.
  std::vector<double> regular(const std::vector<double>& parameters) const;
  /// slope_of_regular returns the difference quotient of that start by a parameter, of order 1 or 2.
  std::vector<double> slope_of_regular(std::size_t parameter, int order) const;

  const ParametricScene& equations_;
  const SensitivitiesAsked& asked_;
  const Scene& scene_;
  double t_;
  /// follows_from_time()
  bool regular_ = false;
  std::size_t size_;
  std::vector<double> x_, rates_;
  std::vector<double> in_velocities_;  ///< (q, v, s, parameters) where the start holds velocities
  tape::Formula momenta_;
};

}  // namespace least::variations
