// energy_momentum on scenes H = ½ pᵀM⁻¹p + V(q) whose size is known when they run: the map of
// core/schemes/energy_momentum.hpp. The velocity v and the length h of a step solve, at the place y = q₀ + (h/2) v,
//   M v + (h/2) ∇V(y) = p₀,  ½ vᵀM v + V(y) = E₀,
// by Newton's method, whose matrix is M + (h²/4) V″, as sparse as the potential, with a border for h: two right sides
// for one decomposition.
#pragma once

#include <concepts>
#include <memory>
#include <vector>

#include "core/catalogue/sized_energy_level.hpp"
#include "core/catalogue/sized_implicit.hpp"
#include "core/schemes/energy_momentum.hpp"

namespace least {

/// In numbers T: double, or dual numbers, whose derivatives are those of the solution.
template <class T>
class SizedEnergyMomentum {
 public:
  SizedEnergyMomentum(const text::SizedScene& scene, const EnergyMomentum& scheme, const T& level);

  /// As a run with this energy begins.
  void begin(const T*, const T& level) { level_ = level; }
  /// A step of its own length, which is left in `h`. One that fails leaves no state.
  StepStatus step(T* x, T& h) noexcept;
  template <std::same_as<RunState> X>
  StepStatus step(X& x) noexcept {  // in numbers
    double h = 0;
    const StepStatus status = step(x.numbers.data(), h);
    x.t += h;
    return status;
  }
  Work work() const { return {work_.forces + nominal_.work().forces, work_.iterations + nominal_.work().iterations}; }
  /// Of the step from a to b.
  double discrete_energy(const RunState& a, const RunState& b) const;
  /// Steps of the nominal length, because there is none that keeps the discrete energy.
  std::int64_t fallback_steps() const { return fallbacks_; }

 private:
  static constexpr double most = 16;  ///< of (h/h₀)², and of its inverse

  /// Leaves v and h, as numbers; false where there are none within bounds.
  bool solve(const T* x);
  double guess();
  /// At v and h the first equation's residual and what both equations change by with h; E_d − E₀.
  double look();
  /// The matrix there; false: it is not to go on.
  bool prepare();
  /// By how much v, in `wrong_` in the place of the first equation's right side, and h are off, where `excess` is the
  /// right side of the second.
  double eliminate(double excess);
  /// v and h with what rides along; false where nothing is known of that.
  bool ride_along(const T* x);

  const text::SizedScene* scene_;
  T level_;
  double step_;
  SizedVariational<T> nominal_;
  std::shared_ptr<PlaceMatrix> matrix_;  ///< shared by copies: it keeps nothing from one step to the next
  std::vector<double> start_, velocity_, place_;
  std::vector<double> pushed_;          ///< M v + (h/2) ∇V(y), which is ∂E_d/∂v
  std::vector<double> wrong_, border_;  ///< border: of the first equation by h
  std::vector<Slope> along_, moved_;
  double h_ = 0, size_ = 0, of_length_ = 0;  ///< h; K + |V|; ∂E_d/∂h
  std::vector<T> v_, y_, slope_;
  T length_{};
  Work work_;
  std::int64_t fallbacks_ = 0;
};

extern template class SizedEnergyMomentum<double>;
extern template class SizedEnergyMomentum<Slope>;

/// The scheme as a run by its own clock takes it.
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
