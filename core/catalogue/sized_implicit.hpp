// The variational schemes of scenes with a constant metric whose size is known only at run time: the maps of
// core/schemes/variational_midpoint.hpp, galerkin_4.hpp, contact_midpoint.hpp and contact_galerkin_4.hpp. With a
// constant metric each of them has one unknown place y, the middle of the step, with
//   M (y − y₀) + β ∇V(y, t) = 0,
// where y₀ and β are known; everything else follows from ∇V(y). Newton's method solves for y with the matrix M + β V″,
// which is as sparse as the couplings of the potential: the cost of a step of a chain is linear in its length.
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

/// PlaceMatrix is the matrix M + β V″(y, t), or for places y_a at several stages, one after the other, the matrix of
/// the blocks M δ_ab + β_ab V″(y_b, t_b), with its factors. For a large scene with couplings between all places they
/// take tenths of a second, and for stages more: it asks whether to go on (AskedByThread), unless it has few rows.
class PlaceMatrix {
 public:
  enum class Curvature : std::uint8_t { of_mean, of_each };

  explicit PlaceMatrix(const text::SizedScene& scene, std::size_t stages = 1);

  /// factor computes the matrix, with V″ at the place of each stage, or at the mean of the places for all stages, and
  /// factors it. `beta` is row-major, `t` has one time for each stage. For a single stage `slope` receives ∇V there,
  /// which comes with V″. False: the computation is to end.
  bool factor(const double* place, const double* beta, const double* t, Curvature at, Work& work,
              double* slope = nullptr);
  /// Replaces b by the solution x.
  void solve(double* b) { system_.solve(b); }
  /// Component i of M x, and of M (x − start).
  double times_mass(std::size_t i, const double* x) const {
    return full_mass_ ? times_row(i, [&](std::size_t j) { return x[j]; }) : mass_[i] * x[i];
  }
  double times_mass(std::size_t i, const double* x, const double* start) const {
    return full_mass_ ? times_row(i, [&](std::size_t j) { return x[j] - start[j]; }) : mass_[i] * (x[i] - start[i]);
  }

 private:
  /// Row i of a full M times x(j).
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
  std::vector<double> mass_;  ///< M: one entry for each coordinate, or row-major if it is full
  std::vector<double> mean_;  ///< mean place of several stages
  SparseSystem system_;
  Held held_;  ///< memory of system_
};

/// PlaceSolver solves M (y − y₀) + β ∇V(y, t) = 0, or such equations for the places at several stages, M (y_a − y₀_a) +
/// Σ_b β_ab ∇V(y_b, t_b) = 0. The solution depends on the arguments alone, not on earlier calls. It fails if the
/// computation is to end (AskedByThread).
class PlaceSolver {
 public:
  explicit PlaceSolver(const text::SizedScene& scene, std::size_t stages = 1);

  /// Starts from the guess y = y₀ = `start`; writes y to `place` and ∇V there to `slope`. `beta` is row-major, `t` has
  /// one time for each stage.
  StepStatus solve(const double* start, const double* beta, const double* t, std::vector<double>& place,
                   std::vector<double>& slope, Work& work);
  /// The same with the derivatives of the solution: M y_a′ + Σ_b β_ab V″(y_b) y_b′ = M y₀_a′.
  StepStatus solve(const Slope* start, const double* beta, const double* t, std::vector<Slope>& place,
                   std::vector<Slope>& slope, Work& work);
  template <class T>
  StepStatus solve(const T* start, double beta, double t, std::vector<T>& place, std::vector<T>& slope, Work& work) {
    return solve(start, &beta, &t, place, slope, work);
  }

 private:
  /// `n` is the number of coordinates, a constant if it is small and there is a single stage.
  template <class Count, class Stages>
  StepStatus iterate(Count n, Stages stages, const double* start, const double* beta, const double* t, double* place,
                     double* slope, Work& work);

  const text::SizedScene* scene_;
  std::size_t stages_;
  PlaceMatrix matrix_;
  std::vector<double> update_;                 ///< correction of the places in a round
  std::vector<double> start_, place_, slope_;  ///< values of arguments with slopes
};

enum class SizedPath : std::uint8_t { straight, parabola };

/// SizedVariational takes steps along straight paths or parabolas, composed as `composition` says. T is double, or dual
/// numbers whose derivatives are those of the solution.
template <class T>
class SizedVariational {
 public:
  /// `components` of the states, with s or, for a damped scene, without it.
  SizedVariational(const text::SizedScene& scene, SizedPath path, const Composition& composition, double step,
                   std::size_t components);

  void begin(const T* x, double t);
  /// If a step fails, the state and the stepper are undefined.
  StepStatus step(T* x, double t, double h) noexcept;
  const Work& work() const { return work_; }
  /// E_d of a step of length h from a state; NaN if the step fails.
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
  bool acts_;                ///< states carry s
  Composition composition_;  ///< keeps the weights
  const Weights<double>* weights_;
  double step_;
  std::vector<T> slope_;     ///< for parabolas: ∇V at the state's q
  std::vector<T> momentum_;  ///< from which velocities are computed
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
