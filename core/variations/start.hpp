// The start of a motion, and how it changes with a number of it or with a parameter.
#pragma once

#include <vector>

#include "core/run/mechanics.hpp"
#include "core/tape/formula.hpp"
#include "core/variations/sensitivities.hpp"

namespace least::variations {

/// Values on the tape of a scene, ready to be evaluated: of the components, and then the parameters.
tape::Formula formula_of(const ParametricScene& scene, const std::vector<Symbol>& all);

class Start {
 public:
  /// Both outlive it.
  Start(const Scene& scene, const SensitivitiesAsked& asked);

  const std::vector<double>& state() const { return x_; }
  /// That of the one regular motion from a singularity before it.
  bool follows_from_time() const { return regular_; }
  /// Its derivative by the quantity, at a fixed time of the run.
  std::vector<double> slope(const Quantity& by) const;
  /// And by two of them; not of the time.
  std::vector<double> second(const Quantity& a, const Quantity& b) const;
  /// Its value, and a start and parameters with another one; not of the time where the start follows from it.
  double value(const Quantity& by) const;
  void move(const Quantity& quantity, double by, Scene& scene) const;

 private:
  template <class T>
  std::vector<T> momenta_of(std::vector<T> x, const T& t) const;
  /// How all that stands in velocities changes, with the parameters.
  std::vector<double> way_of(const Quantity& by) const;
  std::vector<double> slope_in_momenta(const Quantity& by) const;
  std::vector<double> slope_in_velocities(const Quantity& by) const;

  /// The components at the start that the scene has where parameters are these.
  std::vector<double> regular(const std::vector<double>& parameters) const;
  /// Of those the difference quotient of this order by a parameter.
  std::vector<double> slope_of_regular(std::size_t parameter, int order) const;

  const ParametricScene& equations_;
  const SensitivitiesAsked& asked_;
  const Scene& scene_;
  double t_;
  /// The start is that of the one regular motion from a singularity before it: it follows from the time and parameters.
  bool regular_ = false;
  std::size_t size_;
  std::vector<double> x_, rates_;
  std::vector<double> in_velocities_;  ///< with the parameters, where velocities are held
  tape::Formula momenta_;
};

}  // namespace least::variations
