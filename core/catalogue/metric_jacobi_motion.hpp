// jacobi_maupertuis on scenes whose kinetic metric depends on q: the steps of core/schemes/jacobi_maupertuis_step.hpp
// and `variational_step`, among which core/schemes/jacobi_maupertuis_hybrid.hpp chooses, by Newton's method with a
// matrix that is kept as long as rounds contract well.
#pragma once

#include <memory>
#include <vector>

#include "core/catalogue/metric_step.hpp"
#include "core/schemes/jacobi_maupertuis.hpp"

namespace least {

/// T is double, or dual numbers whose derivatives are those of the solution. The public members are those that
/// core/schemes/jacobi_maupertuis_hybrid.hpp requires of a motion.
template <class T>
class MetricJacobiMotion {
 public:
  using Number = T;
  using Numbers = std::vector<T>;
  struct Site {
    Numbers q, p;
    T potential{}, elapsed{};
  };

  MetricJacobiMotion(const text::SizedScene& scene, Quadrature quadrature, const T& level);

  T energy;

  std::size_t size() const { return n_; }
  Site site() const { return {numbers(), numbers(), T(0), T(0)}; }
  Numbers numbers() const { return Numbers(n_); }
  void look(Site& x, Work& work) const;
  void velocity(const Site& x, Numbers& v) const;
  T kinetic(const Site& x) const;
  T scale(const Site& x, std::size_t i) const;
  T steepness(const Site& x) const;
  T gap(const Site& x) const { return energy - x.potential; }
  StepStatus in_time(Site& x, const T& h, Work& work) const;
  /// Moves q^σ by δ and the other variables with it. If the step fails, x is undefined.
  StepStatus along(Site& x, std::size_t sigma, const T& delta, double sign, Work& work) const;
  bool energy_root(Site& x, std::size_t sigma) const;
  T step_energy(const Site& x, const Site& y, const T& h) const;

 private:
  static constexpr int most_iterations = 40;
  static constexpr double epsilon = std::numeric_limits<double>::epsilon();

  /// Looks holds L at both ends of a step or in its middle, and quantities derived from it.
  template <class U>
  struct Looks {
    LagrangianLook<U> here, there;
    std::vector<U> lowered, slope;  ///< ḡΔ; ∇V at the left end or in the middle
    U length_squared{}, gap{}, h{};

    explicit Looks(const text::SizedScene& scene)
        : here(scene), there(scene), lowered(scene.coordinates), slope(scene.coordinates) {}
    /// ∂L/∂q at the velocity Δ/h; `at` is L at the same place with the velocity Δ, `slope` is ∇V there.
    U force(const LagrangianLook<U>& at, std::size_t i) const { return (at.force(i) + slope[i]) / (h * h) - slope[i]; }
    bool admissible() const { return gap > U(0); }
  };
  /// Scratch is filled anew in every step, or caches values at a place.
  struct Scratch {
    LastKnown<T> velocity, gradient, scale;  ///< caches, since the choice of a step needs these repeatedly
    Looks<T> looks;
    Looks<FewDirections> rows;
    SmallNewton<T> in_time, along;
    Numbers v, w, z, end, trial, slope;
    std::vector<FewDirections> row_end;
    std::vector<double> q, p, matrix;

    explicit Scratch(const text::SizedScene& scene);
  };
  /// time_equations writes the residual of a step of length h in time with the velocity v.
  template <class A, class U>
  void time_equations(const A* q, const A* p, const A& h, const U* v, Looks<U>& looks, U* wrong) const;
  /// try_end computes ḡΔ, E₀ − V̄, h and the parts of the force for a step that ends at `end`.
  template <class A, class U>
  void try_end(const A* q, const A& level, double sign, const U* end, Looks<U>& looks) const;
  /// gradient writes ∇V at q.
  void gradient(const Numbers& q, Numbers& slope) const;
  /// along for one degree of freedom.
  StepStatus along_line(Site& x, const T& delta, Work& work) const;
  StepStatus arrive(Site& x, const T& a, double sign, Work& work) const;
  /// K of the momentum p with the mean of the metrics at two places.
  T kinetic_between(const Numbers& a, const Numbers& b, const Numbers& p) const;

  const text::SizedScene* scene_;
  std::size_t n_;
  bool midpoint_;
  std::shared_ptr<Scratch> scratch_;  ///< shared by copies: it keeps nothing from one step to the next
};

extern template class MetricJacobiMotion<double>;
extern template class MetricJacobiMotion<Slope>;

}  // namespace least
