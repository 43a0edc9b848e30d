// jacobi_maupertuis on scenes whose size is known only at run time, by the steps of
// core/catalogue/sized_jacobi_motion.hpp, or core/catalogue/metric_jacobi_motion.hpp.
#pragma once

#include <concepts>

#include "core/catalogue/metric_jacobi_motion.hpp"
#include "core/catalogue/sized_energy_level.hpp"
#include "core/catalogue/sized_jacobi_motion.hpp"

namespace least {

/// The number type is that of Motion: double, or dual numbers whose derivatives are those of the solution.
template <class Motion>
class SizedJacobiMaupertuis {
  using T = typename Motion::Number;

 public:
  SizedJacobiMaupertuis(const text::SizedScene& scene, const JacobiMaupertuis& scheme, const T& level)
      : hybrid_(Motion(scene, scheme.quadrature, level), scheme) {}

  /// Starts at x as a run with this energy does.
  void begin(const T* x, const T& level);
  /// Takes a step from there, or from the end of the last step, and writes its length to `h`.
  StepStatus step(T* x, T& h) noexcept;
  template <std::same_as<RunState> X>
  StepStatus step(X& x) noexcept {  // in plain numbers
    double h = 0;
    const StepStatus status = step(x.numbers.data(), h);
    x.t += h;
    return status;
  }
  const ActiveMethod& active_method() const { return hybrid_.active_method(); }
  void go_on(const ActiveMethod& course) { hybrid_.go_on(course); }
  Work work() const { return hybrid_.work(); }
  /// The discrete energy of the step from a to b, taken by the method `course`.
  double discrete_energy(const RunState& a, const RunState& b, const ActiveMethod& course) const;
  std::int64_t fallback_steps() const { return hybrid_.fallback_steps(); }

 private:
  void put(const T* x);

  JacobiMaupertuisHybrid<Motion> hybrid_;
};

extern template class SizedJacobiMaupertuis<SizedJacobiMotion<double>>;
extern template class SizedJacobiMaupertuis<SizedJacobiMotion<Slope>>;
extern template class SizedJacobiMaupertuis<MetricJacobiMotion<double>>;
extern template class SizedJacobiMaupertuis<MetricJacobiMotion<Slope>>;

/// SizedJacobiScheme is the scheme in the form that SelfTimedIntegrator needs.
template <class Motion>
struct SizedJacobiScheme {
  JacobiMaupertuis chosen;
  const text::SizedScene* scene;

  static constexpr bool own_clock = true;
  template <class P>
  double level(const P&, const RunState& x) const {
    return energy_of_start(*scene, x.numbers.data()).value;
  }
  template <class P>
  SizedJacobiMaupertuis<Motion> bind(const P&, const RunState& x, double level) const {
    SizedJacobiMaupertuis<Motion> stepper(*scene, chosen, level);
    stepper.begin(x.numbers.data(), level);
    return stepper;
  }
};

}  // namespace least
