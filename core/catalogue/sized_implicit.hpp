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

#include "core/memory_budget.hpp"
#include "core/number/sparse_system.hpp"
#include "core/problem_traits.hpp"
#include "core/run/run_state.hpp"
#include "core/scheme.hpp"
#include "core/text/sized_scene.hpp"

namespace least {

/// Solves M (y − y₀) + β ∇V(y, t) = 0. What a solution is depends on the arguments alone. Of a scene in which all
/// places are coupled it takes tenths of a second: it asks whether it is to go on (AskedByThread), else it has failed.
class PlaceSolver {
 public:
  explicit PlaceSolver(const text::SizedScene& scene);

  /// From the guess y = y₀; leaves y in `place` and ∇V there in `slope`.
  StepStatus solve(const double* start, double beta, double t, std::vector<double>& place, std::vector<double>& slope,
                   Work& work);
  /// With the derivatives of the solution: (M + β V″) y′ = M y₀′.
  StepStatus solve(const Slope* start, double beta, double t, std::vector<Slope>& place, std::vector<Slope>& slope,
                   Work& work);

 private:
  /// False: it is not to go on.
  bool prepare(const std::vector<double>& place, double beta, double t, Work& work);
  /// What M makes of x, from its start; the i-th entry.
  double times_mass(std::size_t i, const double* x, const double* start) const;

  const text::SizedScene* scene_;
  std::vector<double> mass_;                   ///< of each coordinate, or row by row
  std::vector<double> update_;                 ///< of the place, in a round
  SparseSystem system_;                        ///< M + β V″
  std::vector<double> start_, place_, slope_;  ///< values of what has slopes
  Held held_;                                  ///< for the system
};

enum class SizedPath : std::uint8_t { straight, parabola };

/// In numbers T: double, or dual numbers, whose derivatives are those of the solution.
template <class T>
class SizedVariational {
 public:
  /// `components`: of the states, with s or, of a damped scene, without it.
  SizedVariational(const text::SizedScene& scene, SizedPath path, const Composition& composition, double step,
                   std::size_t components);

  void begin(const T* x, double t);
  /// A step that fails leaves neither the state nor the stepper as they were.
  StepStatus step(T* x, double t, double h) noexcept;
  const Work& work() const { return work_; }
  /// E_d of a step of length h from a state; not a number where there is none.
  double step_energy(StateView from, double h);
  std::string unsupported_reason() const;
  double flips_from() const;
  double stiff_from() const;

 private:
  StepStatus midpoint(T* x, double t, double h);
  StepStatus simpson(T* x, double t, double h);
  T potential(const T* q, double t) const;
  T twice_kinetic(const T* p, const T* v) const;

  const text::SizedScene* scene_;
  SizedPath path_;
  bool acts_;                ///< states have s
  Composition composition_;  ///< keeps the weights
  const Weights<double>* weights_;
  double step_;
  std::vector<T> slope_;     ///< ∇V at the state's q, of parabolas
  std::vector<T> momentum_;  ///< of which velocities are made
  std::vector<T> guess_, velocity_;
  std::vector<T> middle_, bent_;         ///< the place in the middle of the step, and ∇V there
  std::shared_ptr<PlaceSolver> solver_;  ///< shared by copies: it keeps nothing from one step to the next
  bool asks_energy_ = false;
  T energy_{};  ///< E_d of the last stage, if that is asked for
  Work work_;
};

extern template class SizedVariational<double>;
extern template class SizedVariational<Slope>;

}  // namespace least
