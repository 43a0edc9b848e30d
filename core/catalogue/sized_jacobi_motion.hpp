// jacobi_maupertuis on scenes H = ½ pᵀM⁻¹p + V(q) whose size is known only at run time: the steps among which
// core/schemes/jacobi_maupertuis_hybrid.hpp chooses. With a constant metric a step of the Jacobi–Maupertuis principle
// is a step of Hamilton's principle of unknown time h, with a push λ on the coordinate that is the parameter:
//   M Δ = h p₀ − (h²/2) ∇V + λ e_σ,  Δ_σ = δ,  ΔᵀM Δ = 2h² (E₀ − V̄).
// With the trapezoid rule ∇V is known beforehand, and Δ and λ are functions of h: one equation for h is left. With the
// midpoint rule ∇V and V̄ are taken at y = q₀ + Δ/2: Newton's method solves for (y, h, λ), by the decomposition of
// M + (h²/4) V″.
#pragma once

#include <memory>
#include <vector>

#include "core/catalogue/sized_implicit.hpp"
#include "core/schemes/jacobi_maupertuis.hpp"

namespace least {

/// T is double, or dual numbers whose derivatives are those of the solution. The public members are those that
/// core/schemes/jacobi_maupertuis_hybrid.hpp requires of a motion.
template <class T>
class SizedJacobiMotion {
 public:
  using Number = T;
  using Numbers = std::vector<T>;
  struct Site {
    Numbers q, p, slope;  ///< slope: ∇V
    T potential{}, elapsed{};
  };

  SizedJacobiMotion(const text::SizedScene& scene, Quadrature quadrature, const T& level);

  T energy;

  std::size_t size() const { return scene_->coordinates; }
  Site site() const { return {numbers(), numbers(), numbers(), T(0), T(0)}; }
  Numbers numbers() const { return Numbers(size()); }
  void look(Site& x, Work& work) const;
  void velocity(const Site& x, Numbers& v) const { scene_->velocity(x.p.data(), v.data()); }
  T kinetic(const Site& x) const { return 0.5 * with_inverse_mass(x.p); }
  T scale(const Site&, std::size_t i) const { return T(scale_[i]); }
  T steepness(const Site& x) const;
  T gap(const Site& x) const { return energy - x.potential; }
  StepStatus in_time(Site& x, const T& h, Work& work) const;
  /// Moves q^σ by δ and the other variables with it. If the step fails, x is undefined.
  StepStatus along(Site& x, std::size_t sigma, const T& delta, double sign, Work& work) const;
  bool energy_root(Site& x, std::size_t sigma) const;
  T step_energy(const Site& x, const Site& y, const T& h) const;

 private:
  static constexpr int most_iterations = 40, most_halvings = 30;
  /// Additional rounds after convergence, since derivatives in dual numbers converge a round later.
  static constexpr int late_rounds = std::is_same_v<T, double> ? 0 : 1;

  /// Scratch is filled anew in every step.
  struct Scratch {
    Numbers v, w, free, bent, end, slope, wrong;
    std::vector<double> place, start, border, column, part;
  };
  /// aᵀM⁻¹a
  T with_inverse_mass(const Numbers& a) const;
  /// Returns V at q, and writes ∇V to `slope`.
  T look_at(const Numbers& q, Numbers& slope, Work& work) const;
  StepStatus middle_step(Site& x, const T& h, Work& work) const;
  StepStatus along_trapezoid(Site& x, std::size_t sigma, const T& delta, const T& a, Work& work) const;
  StepStatus along_midpoint(Site& x, std::size_t sigma, const T& delta, const T& a, Work& work) const;
  /// along for one degree of freedom.
  StepStatus along_line(Site& x, const T& delta, Work& work) const;
  /// Solves with the factors of matrix_, in place.
  void solve(Numbers& b) const;
  /// grain_of returns the size of a change of h that is below round-off, on a way of length v h.
  double grain_of(const Numbers& q, const T& a) const;

  const text::SizedScene* scene_;
  Quadrature quadrature_;
  bool slow_;                  ///< forces take long, so it asks now and then whether to go on (AskedByThread)
  std::vector<double> scale_;  ///< √M_ii
  // Shared by copies, since they keep nothing from one step to the next. The first two are only for the midpoint rule.
  std::shared_ptr<PlaceMatrix> matrix_;
  std::shared_ptr<PlaceSolver> solver_;
  std::shared_ptr<Scratch> scratch_;
};

extern template class SizedJacobiMotion<double>;
extern template class SizedJacobiMotion<Slope>;

}  // namespace least
