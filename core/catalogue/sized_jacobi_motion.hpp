// jacobi_maupertuis on scenes H = ½ pᵀM⁻¹p + V(q) whose size is known when they run: the steps that
// core/schemes/jacobi_maupertuis_hybrid.hpp chooses among. Where the metric is constant a step of the
// Jacobi–Maupertuis principle is one of Hamilton's whose time h is unknown, and which pushes the parameter by λ:
//   M Δ = h p₀ − (h²/2) ∇V + λ e_σ,  Δ_σ = δ,  ΔᵀM Δ = 2h² (E₀ − V̄).
// With the trapezoid ∇V is known beforehand, and Δ and λ with h: one equation for h is left. With the midpoint rule ∇V
// and V̄ are taken at y = q₀ + Δ/2: Newton's method for (y, h, λ), by the decomposition of M + (h²/4) V″.
#pragma once

#include <memory>
#include <vector>

#include "core/catalogue/sized_implicit.hpp"
#include "core/schemes/jacobi_maupertuis.hpp"

namespace least {

/// In numbers T: double, or dual numbers, whose derivatives are those of the solution.
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
  /// Moves q^σ by δ, and everything else with it. A site that a step failed from is spoilt.
  StepStatus along(Site& x, std::size_t sigma, const T& delta, double sign, Work& work) const;
  bool energy_root(Site& x, std::size_t sigma) const;
  T step_energy(const Site& x, const Site& y, const T& h) const;

 private:
  static constexpr int most_iterations = 40, most_halvings = 30;
  /// Rounds that go on once the solution is there: derivatives that ride along converge a round later.
  static constexpr int late_rounds = std::is_same_v<T, double> ? 0 : 1;

  /// What is filled anew in every step.
  struct Scratch {
    Numbers v, w, free, bent, end, slope, wrong;
    std::vector<double> place, start, border, column, part;
  };
  /// aᵀM⁻¹a
  T with_inverse_mass(const Numbers& a) const;
  /// V and ∇V.
  T look_at(const Numbers& q, Numbers& slope, Work& work) const;
  StepStatus middle_step(Site& x, const T& h, Work& work) const;
  StepStatus along_trapezoid(Site& x, std::size_t sigma, const T& delta, const T& a, Work& work) const;
  StepStatus along_midpoint(Site& x, std::size_t sigma, const T& delta, const T& a, Work& work) const;
  /// One degree of freedom.
  StepStatus along_line(Site& x, const T& delta, Work& work) const;
  /// By the factors of the matrix.
  void solve(Numbers& b) const;
  /// How small a change of h means nothing, where the way is v h.
  double grain_of(const Numbers& q, const T& a) const;

  const text::SizedScene* scene_;
  Quadrature quadrature_;
  bool slow_;                  ///< its forces take long: it asks now and then whether it is to go on
  std::vector<double> scale_;  ///< √M_ii
  // Shared by copies: they keep nothing from one step to the next. The first two are of the midpoint rule alone.
  std::shared_ptr<PlaceMatrix> matrix_;
  std::shared_ptr<PlaceSolver> solver_;
  std::shared_ptr<Scratch> scratch_;
};

extern template class SizedJacobiMotion<double>;
extern template class SizedJacobiMotion<Slope>;

}  // namespace least
