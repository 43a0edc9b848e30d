// The variational schemes of scenes whose size is known when they run, with a constant metric: the maps of
// core/schemes/variational_midpoint.hpp, galerkin_4.hpp, contact_midpoint.hpp and contact_galerkin_4.hpp. Where the
// metric is constant each of them comes down to one place y that is not known beforehand, with
//   M (y − y₀) + β ∇V(y, t) = 0,
// the middle of the step: y₀ and β are known, and everything else follows from ∇V(y). It is found by Newton's method
// with M + β V″, whose entries stand where the potential couples coordinates: a step of a chain costs what the chain is
// long.
#pragma once

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "core/number/sparse_system.hpp"
#include "core/run/run_state.hpp"
#include "core/scheme.hpp"
#include "core/text/sized_scene.hpp"

namespace least {

/// Solves M (y − y₀) + β ∇V(y, t) = 0. What a solution is depends on the arguments alone.
class PlaceSolver {
 public:
  explicit PlaceSolver(const text::SizedScene& scene);

  /// From the guess y = y₀; leaves ∇V there in `slope`.
  StepStatus solve(const double* start, double beta, double t, Work& work);

  std::vector<double> place, slope;

 private:
  void prepare(double beta, double t, Work& work);

  const text::SizedScene* scene_;
  std::vector<double> mass_;    ///< of each coordinate, or row by row
  std::vector<double> update_;  ///< of the place, in a round
  SparseSystem system_;         ///< M + β V″
};

class SizedVariational {
 public:
  enum class Path : std::uint8_t { straight, parabola };

  SizedVariational(const text::SizedScene& scene, Path path, const Composition& composition, double step);

  void begin(StateView x);
  /// A step that fails leaves neither the state nor the stepper as they were.
  StepStatus step(double* x, double t, double h) noexcept;
  const Work& work() const { return work_; }
  /// E_d of a step of length h from a state; not a number where there is none.
  double step_energy(StateView from, double h);
  std::string unsupported_reason() const;
  double flips_from() const;
  double stiff_from() const;

 private:
  StepStatus midpoint(double* x, double t, double h);
  StepStatus simpson(double* x, double t, double h);
  double damping(double t) const;
  double potential(const double* q, double t) const;
  double twice_kinetic(const double* p, const double* v) const;

  const text::SizedScene* scene_;
  Path path_;
  Composition composition_;  ///< keeps the weights
  const Weights<double>* weights_;
  double step_;
  std::vector<double> slope_;     ///< ∇V at the state's q, of parabolas
  std::vector<double> momentum_;  ///< of which velocities are made
  std::vector<double> guess_, velocity_;
  std::shared_ptr<PlaceSolver> solver_;  ///< shared by copies: it keeps nothing from one step to the next
  bool asks_energy_ = false;
  double energy_ = 0;  ///< E_d of the last stage, if that is asked for
  Work work_;
};

}  // namespace least
