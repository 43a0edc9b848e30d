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

/// The matrix M + β V″(y, t), or of places y_a at some stages that stand one after the other the blocks
/// M δ_ab + β_ab V″(y_b, t_b), with its factors. Of a large scene in which all places are coupled they take tenths of a
/// second, and of stages longer: it asks whether it is to go on (AskedByThread), unless it has few rows.
class PlaceMatrix {
 public:
  enum class Curvature : std::uint8_t { of_mean, of_each };

  explicit PlaceMatrix(const text::SizedScene& scene, std::size_t stages = 1);

  /// With V″ at the places of all stages, or at their mean for all of them. `beta`: row by row; `t`: of each stage.
  /// False: it is not to go on. `slope`: leaves ∇V there, of a single stage; it comes with V″.
  bool factor(const double* place, const double* beta, const double* t, Curvature at, Work& work,
              double* slope = nullptr);
  /// x in the place of b, by the factors.
  void solve(double* b) { system_.solve(b); }
  /// What M makes of x, and of x less its start; the i-th entry.
  double times_mass(std::size_t i, const double* x) const {
    return full_mass_ ? times_row(i, [&](std::size_t j) { return x[j]; }) : mass_[i] * x[i];
  }
  double times_mass(std::size_t i, const double* x, const double* start) const {
    return full_mass_ ? times_row(i, [&](std::size_t j) { return x[j] - start[j]; }) : mass_[i] * (x[i] - start[i]);
  }

 private:
  /// The i-th row of a full M by x(j).
  template <class X>
  double times_row(std::size_t i, X&& x) const {
    const std::size_t n = scene_->coordinates;
    double sum = 0;
    for (std::size_t j = 0; j < n; ++j) sum += mass_[i * n + j] * x(j);
    return sum;
  }
  bool goes_on() const;

  const text::SizedScene* scene_;
  std::size_t stages_;
  bool full_mass_;
  std::vector<double> mass_;  ///< of each coordinate, or row by row
  std::vector<double> mean_;  ///< place, of several stages
  SparseSystem system_;
  Held held_;  ///< for it
};

/// Solves M (y − y₀) + β ∇V(y, t) = 0, or such equations of the places at some stages,
/// M (y_a − y₀_a) + Σ_b β_ab ∇V(y_b, t_b) = 0. What a solution is depends on the arguments alone. Where it is not to go
/// on (AskedByThread) it has failed.
class PlaceSolver {
 public:
  explicit PlaceSolver(const text::SizedScene& scene, std::size_t stages = 1);

  /// From the guess y = y₀; leaves y in `place` and ∇V there in `slope`. `beta`: row by row; `t`: of each stage.
  StepStatus solve(const double* start, const double* beta, const double* t, std::vector<double>& place,
                   std::vector<double>& slope, Work& work);
  /// With the derivatives of the solution: M y_a′ + Σ_b β_ab V″(y_b) y_b′ = M y₀_a′.
  StepStatus solve(const Slope* start, const double* beta, const double* t, std::vector<Slope>& place,
                   std::vector<Slope>& slope, Work& work);
  template <class T>
  StepStatus solve(const T* start, double beta, double t, std::vector<T>& place, std::vector<T>& slope, Work& work) {
    return solve(start, &beta, &t, place, slope, work);
  }

 private:
  /// `n`: coordinates, a constant where there are few of a single stage.
  template <class Count, class Stages>
  StepStatus iterate(Count n, Stages stages, const double* start, const double* beta, const double* t, double* place,
                     double* slope, Work& work);

  const text::SizedScene* scene_;
  std::size_t stages_;
  PlaceMatrix matrix_;
  std::vector<double> update_;                 ///< of the places, in a round
  std::vector<double> start_, place_, slope_;  ///< values of what has slopes
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
