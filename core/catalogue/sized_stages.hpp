// Steps of equal length that solve for their stages, on scenes whose number of coordinates is known only at run time:
// pairs of Runge–Kutta methods, one for q and one for p. The discrete Lagrange–d'Alembert principle with polynomial
// paths and a quadrature rule is such a pair, for any regular H with forces F(q, p, t) beside −H_q. So is collocation
// at Gauss nodes: without s it is the map of core/schemes/hamiltonian_gauss.hpp; with s it is applied to the lift of H,
// as there. A forced scene carries the work of its forces as its last component. Sources: Marsden & West, Acta Numerica
// 10, 357 (2001), part 3; Hairer, Lubich, Wanner 2006, II.2.1 and VI.4.
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <vector>

#include "core/catalogue/sized_newton.hpp"
#include "core/composition.hpp"
#include "core/problem_traits.hpp"
#include "core/scheme.hpp"
#include "core/simplified_newton.hpp"
#include "core/text/sized_scene.hpp"

namespace least {

/// StageRule holds the coefficients of such a pair.
struct StageRule {
  static constexpr std::size_t most_stages = 3;
  using Square = std::array<std::array<double, most_stages>, most_stages>;

  std::size_t stages;
  Square of_places, of_momenta;
  std::array<double, most_stages> weight, node;
  bool parabolas = false;  ///< Lobatto's pair IIIA–IIIB with velocities that are linear in time

  static const StageRule midpoint;  ///< straight paths: the implicit midpoint rule
  static const StageRule simpson;   ///< parabolas with Simpson's rule
  static StageRule gauss(int stages);
};

/// T is double, or dual numbers whose derivatives are those of the solution.
template <class T>
class SizedStages {
 public:
  SizedStages(const text::SizedScene& scene, const StageRule& rule, const Composition& composition);

  void begin(const T*, double) { work_ = {}; }
  StepStatus step(T* x, double t, double h) noexcept;
  const Work& work() const { return work_; }
  double flips_from() const { return std::numeric_limits<double>::infinity(); }

 private:
  /// Lifted is the state that a point of the lift stands for, and its rates, in the number U.
  template <class U>
  struct Lifted {
    std::vector<U> state, rate;
  };

  StepStatus stage(T* x, double t, double h);
  /// prepare computes and factors the matrix 1 − h A ⊗ J with J at the point y. False: the computation is to end
  /// (AskedByThread).
  bool prepare(const double* y, double t, double h);
  /// put_columns writes the entries of the matrix that come from `count` columns of J, the first of which is column
  /// `first`.
  void put_columns(std::size_t first, std::size_t count, double h);
  /// rates writes the rates of all components at y; for an H with s those of its lift (q, P_q, s, P_s).
  template <class U>
  void rates(const U* y, double t, U* rate, Lifted<U>& lifted) const;
  /// start converts the state at the start of a step to the components that have rates, finish converts back. False at
  /// a pole of p.
  void start(const T* x);
  bool finish(T* x) const;
  bool is_lifted() const { return scene_->acting; }
  const auto& part(std::size_t i) const { return i < width_ / 2 ? rule_.of_places : rule_.of_momenta; }
  bool is_bent(std::size_t i) const { return rule_.parabolas && i >= width_ / 2; }
  /// kind(i) is the same for components with the same unit: places, momenta, s, P_s.
  std::size_t kind(std::size_t i) const {
    const std::size_t n = scene_->coordinates;
    return i < n ? 0 : i < 2 * n ? 1 : i - 2 * n + 2;
  }

  const text::SizedScene* scene_;
  StageRule rule_;
  Composition composition_;  ///< keeps the weights
  const Weights<double>* weights_;
  std::size_t width_, row_;           ///< number of components that are solved for, and of those that have rates
  std::vector<T> from_, at_, rates_;  ///< start of the step; a stage; rates at the stages
  std::vector<T> z_;                  ///< stages minus the start
  std::vector<double> middle_;        ///< point at which the matrix is computed
  std::array<double, 4> weighs_{};    ///< weight that makes each kind dimensionless
  std::vector<FewDirections> along_, moved_;  ///< a point and its rates, with derivatives along some directions
  Lifted<T> lifted_;
  Lifted<FewDirections> lifted_along_;
  std::shared_ptr<SimplifiedNewton<T>> newton_;  ///< shared by copies: it keeps nothing from one step to the next
  bool slow_;  ///< rates take long, so it asks now and then whether to go on (AskedByThread)
  Work work_;
};

extern template class SizedStages<double>;
extern template class SizedStages<Slope>;

}  // namespace least
