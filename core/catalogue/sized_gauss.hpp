// contact_gauss on scenes H = ½ pᵀM⁻¹p + V(q, t) + α(t) s whose size is known only at run time: the map of
// core/schemes/contact_gauss.hpp. P_s at the stages, σ_i, is known beforehand, and momenta follow from the slopes of V,
//   p_i = (p₀ − h Σ_k a_ik σ_k ∇V(q_k)) / σ_i,
// so that only the places at the stages are unknown:
//   M (q_i − q₀ − h Σ_j a_ij v₀/σ_j) + h² Σ_k (Σ_j a_ij a_jk σ_k/σ_j) ∇V(q_k) = 0.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "core/catalogue/sized_implicit.hpp"
#include "core/catalogue/sized_stages.hpp"
#include "core/schemes/contact_gauss.hpp"

namespace least {

/// T is double, or dual numbers whose derivatives are those of the solution.
template <class T>
class SizedGauss {
 public:
  /// `components` of the states, with or without s.
  SizedGauss(const text::SizedScene& scene, const ContactGauss& scheme, std::size_t components);

  void begin(const T*, double) { work_ = {}; }
  /// A step that fails leaves the state as it was.
  StepStatus step(T* x, double t, double h) noexcept;
  const Work& work() const { return work_; }
  double flips_from() const { return scheme_.flips_from(); }
  double stiff_from() const { return scheme_.stiff_from(*scene_); }

 private:
  using Few = std::array<double, StageRule::most_stages>;
  using Square = std::array<double, StageRule::most_stages * StageRule::most_stages>;

  /// scales returns σ at the stages.
  Few scales(const Few& alpha, double h) const;
  /// move_action advances s by ṡ = K − V − α s with the same collocation, which is linear in s.
  void move_action(T& s, const T* p, const Few& time, const Few& alpha, const Few& scale, double h);

  const text::SizedScene* scene_;
  ContactGauss scheme_;
  StageRule rule_;
  bool acts_;  ///< states carry s
  std::vector<T> momentum_, velocity_;
  std::vector<T> guess_, place_, slope_;  ///< of all stages: places without forces, places, and ∇V there
  std::shared_ptr<PlaceSolver> solver_;   ///< shared by copies: it keeps nothing from one step to the next
  Work work_;
};

extern template class SizedGauss<double>;
extern template class SizedGauss<Slope>;

}  // namespace least
