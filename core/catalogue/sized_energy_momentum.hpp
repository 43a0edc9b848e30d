// energy_momentum on scenes H = ½ pᵀM⁻¹p + V(q) whose size is known only at run time: the map of
// core/schemes/energy_momentum.hpp. The velocity v and the length h of a step solve, at the place y = q₀ + (h/2) v,
//   M v + (h/2) ∇V(y) = p₀,  ½ vᵀM v + V(y) = E₀,
// by Newton's method. Its matrix is M + (h²/4) V″, as sparse as the potential, with a border for h, so that one
// decomposition solves for two right sides.
#pragma once

#include <concepts>
#include <memory>
#include <vector>

#include "core/catalogue/sized_energy_level.hpp"
#include "core/catalogue/sized_implicit.hpp"
#include "core/schemes/energy_momentum.hpp"

namespace least {

/// T is double, or dual numbers whose derivatives are those of the solution.
template <class T>
class SizedEnergyMomentum {
 public:
  SizedEnergyMomentum(const text::SizedScene& scene, const EnergyMomentum& scheme, const T& level);

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

  /// Solves for v and h in plain numbers; false if there is no solution within the bounds.
  bool solve(const T* x);
  double guess();
  /// Evaluates at v and h the residual of the first equation and the derivatives of both equations by h; returns the
  /// energy error E_d − E₀.
  double look();
  /// Computes and factors the matrix there; false: the computation is to end (AskedByThread).
  bool prepare();
  /// Solves the bordered system for the corrections of v, in place of the right side in `wrong_`, and of h, which it
  /// returns; `excess` is the right side of the second equation.
  double eliminate(double excess);
  /// Writes v and h with their derivatives; false if the derivatives cannot be computed.
  bool ride_along(const T* x);

  const text::SizedScene* scene_;
  T level_;
  double step_;
  SizedVariational<T> nominal_;
  std::shared_ptr<PlaceMatrix> matrix_;  ///< shared by copies: it keeps nothing from one step to the next
  std::vector<double> start_, velocity_, place_;
  std::vector<double> pushed_;          ///< M v + (h/2) ∇V(y), which is ∂E_d/∂v
  std::vector<double> wrong_, border_;  ///< border_: derivative of the first equation by h
  std::vector<Slope> along_, moved_;
  double h_ = 0, size_ = 0, of_length_ = 0;  ///< h; K + |V|; ∂E_d/∂h
  std::vector<T> v_, y_, slope_;
  T length_{};
  Work work_;
  std::int64_t fallbacks_ = 0;
};

extern template class SizedEnergyMomentum<double>;
extern template class SizedEnergyMomentum<Slope>;

/// SizedEnergyMomentumScheme is the scheme in the form that SelfTimedIntegrator needs.
template <class Stepper>
struct SizedEnergyMomentumScheme {
  EnergyMomentum chosen;
  const text::SizedScene* scene;

  static constexpr bool own_clock = true;
  template <class P>
  double level(const P&, const RunState& x) const {
    return energy_of_first_step(*scene, x.numbers.data(), chosen.step).value;
  }
  template <class P>
  Stepper bind(const P&, const RunState&, double level) const {
    return {*scene, chosen, level};
  }
};

}  // namespace least
