// Steps of equal length that solve for their stages, on scenes whose number of coordinates is known when they run:
// pairs of Runge–Kutta methods, one for q and one for p. The discrete Lagrange–d'Alembert principle of a path of
// polynomials and a rule of quadrature is such a pair, for any regular H with forces F(q, p, t) beside −H_q; so is
// collocation at Gauss' nodes, of an H without s the map of core/schemes/hamiltonian_gauss.hpp; of an H with s the same
// is done with its lift, as there. A forced scene carries the work of its forces as its last component. Sources:
// Marsden & West, Acta Numerica 10, 357 (2001), part 3; Hairer, Lubich, Wanner 2006, II.2.1 and VI.4.
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

/// The coefficients of such a pair.
struct StageRule {
  static constexpr std::size_t most_stages = 3;
  using Square = std::array<std::array<double, most_stages>, most_stages>;

  std::size_t stages;
  Square of_places, of_momenta;
  std::array<double, most_stages> weight, node;
  bool parabolas = false;  ///< of Lobatto's pair IIIA–IIIB: with velocities that are linear in time

  static const StageRule midpoint;  ///< of straight paths: the implicit midpoint rule
  static const StageRule simpson;   ///< of parabolas
  static StageRule gauss(int stages);
};

/// In numbers T: double, or dual numbers, whose derivatives are those of the solution.
template <class T>
class SizedStages {
 public:
  SizedStages(const text::SizedScene& scene, const StageRule& rule, const Composition& composition);

  void begin(const T*, double) { work_ = {}; }
  StepStatus step(T* x, double t, double h) noexcept;
  const Work& work() const { return work_; }
  double flips_from() const { return std::numeric_limits<double>::infinity(); }

 private:
  /// Of a point of the lift, in the number U: the state that it stands for, and its rates.
  template <class U>
  struct Lifted {
    std::vector<U> state, rate;
  };

  StepStatus stage(T* x, double t, double h);
  /// 1 − h A ⊗ J with J at the point y, and its factors. False: it is not to go on (AskedByThread).
  bool prepare(const double* y, double t, double h);
  /// Writes the entries of the matrix that `count` columns of J from the one of `first` on make up.
  void put_columns(std::size_t first, std::size_t count, double h);
  /// Of all components at a point; of an H with s those of its lift (q, P_q, s, P_s).
  template <class U>
  void rates(const U* y, double t, U* rate, Lifted<U>& lifted) const;
  /// Where a step begins, in the components of which there are rates; and back. False at a pole of p.
  void start(const T* x);
  bool finish(T* x) const;
  bool is_lifted() const { return scene_->acting; }
  const auto& part(std::size_t i) const { return i < width_ / 2 ? rule_.of_places : rule_.of_momenta; }
  bool is_bent(std::size_t i) const { return rule_.parabolas && i >= width_ / 2; }
  /// Components of one kind have one unit: places, momenta, s, P_s.
  std::size_t kind(std::size_t i) const {
    const std::size_t n = scene_->coordinates;
    return i < n ? 0 : i < 2 * n ? 1 : i - 2 * n + 2;
  }

  const text::SizedScene* scene_;
  StageRule rule_;
  Composition composition_;  ///< keeps the weights
  const Weights<double>* weights_;
  std::size_t width_, row_;                   ///< components that are solved for, and all of which there are rates
  std::vector<T> from_, at_, rates_;          ///< where the step began; a stage; the rates at the stages
  std::vector<T> z_;                          ///< stages less the start
  std::vector<double> middle_;                ///< where the matrix is made
  std::array<double, 4> weighs_{};            ///< what brings each kind to one unit
  std::vector<FewDirections> along_, moved_;  ///< a point and the rates there, with their changes in some directions
  Lifted<T> lifted_;
  Lifted<FewDirections> lifted_along_;
  std::shared_ptr<SimplifiedNewton<T>> newton_;  ///< shared by copies: it keeps nothing from one step to the next
  bool slow_;                                    ///< its rates take long: it asks now and then whether it is to go on
  Work work_;
};

extern template class SizedStages<double>;
extern template class SizedStages<Slope>;

}  // namespace least
