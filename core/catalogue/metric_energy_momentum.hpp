// energy_momentum on scenes whose kinetic metric depends on q: the map of
// core/schemes/energy_momentum.hpp. The velocity v and the length h of a step solve, at m = q₀ + (h/2) v,
//   g(m) v − (h/2) ∂L/∂q(m, v) = p₀,  v·∂L/∂v − L = E₀.
#pragma once

#include <concepts>
#include <memory>

#include "core/catalogue/metric_step.hpp"
#include "core/catalogue/sized_energy_level.hpp"
#include "core/catalogue/sized_herglotz.hpp"
#include "core/schemes/energy_momentum.hpp"

namespace least {

/// T is double, or dual numbers whose derivatives are those of the solution.
template <class T>
class MetricEnergyMomentum {
 public:
  MetricEnergyMomentum(const text::SizedScene& scene, const EnergyMomentum& scheme, const T& level);

  /// Starts as a run with this energy does.
  void begin(const T*, const T& level) { level_ = level; }
  /// Takes a step and writes its length to `h`. If it fails, x is undefined.
  StepStatus step(T* x, T& h) noexcept;
  template <std::same_as<RunState> X>
  StepStatus step(X& x) noexcept {  // in plain numbers
    double h = 0;
    const StepStatus status = step(x.numbers.data(), h);
    x.t += h;
    return status;
  }
  Work work() const { return {work_.forces + nominal_.work().forces, work_.iterations + nominal_.work().iterations}; }
  /// The discrete energy of the step from a to b.
  double discrete_energy(const RunState& a, const RunState& b) const;
  /// The number of steps of the nominal length, taken where no length conserves the discrete energy.
  std::int64_t fallback_steps() const { return fallbacks_; }

 private:
  static constexpr double most = 16;  ///< bound on (h/h₀)² and its inverse

  /// Solves for v and (h/h₀)², in z_; false if there is no solution within the bounds.
  bool solve(const T* x);
  T guess(const T* x);
  /// Evaluates L in the middle of a step with the velocity and length in z; returns the length.
  template <class A, class U>
  U look(const A* x, const U* z, LagrangianLook<U>& middle) const;
  template <class A, class U>
  void equations(const A* x, const A& level, const U* z, LagrangianLook<U>& middle, U* wrong) const;

  const text::SizedScene* scene_;
  T level_;
  double step_;
  std::size_t n_;
  SizedHerglotz<T> nominal_;
  std::shared_ptr<SmallNewton<T>> newton_;  ///< shared by copies: it keeps nothing from one step to the next
  LagrangianLook<T> middle_;
  LagrangianLook<FewDirections> row_;
  std::vector<T> z_, p_;
  std::vector<double> start_;
  Work work_;
  std::int64_t fallbacks_ = 0;
};

extern template class MetricEnergyMomentum<double>;
extern template class MetricEnergyMomentum<Slope>;

}  // namespace least
