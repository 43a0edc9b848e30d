// A local frequency that does not vanish where a motion goes through an inflection of V: there V″ does not bound the
// length of a step, and steps that follow it would become arbitrarily long. With ω² = ‖g⁻¹V″‖ the squared frequency is
//   ω² itself where it exceeds 2F, else F + ω⁴/4F, which joins it smoothly,
//   F = ½ ω₀² (K/(K + K₀))^{3/2}, K = E₀ − V
// where ω₀ is that of the start, and K₀ the larger of its kinetic energy and ∇V·g⁻¹∇V/2ω₀², the kinetic energy that a
// motion from rest reaches. A harmonic motion keeps its frequency. It depends on q alone, so steps stay reversible.
#pragma once

#include <algorithm>
#include <cmath>

namespace least {

class FrequencyFloor {
 public:
  FrequencyFloor() = default;
  /// `start`, `force` and `kinetic` are ω₀², ∇V·g⁻¹∇V and the kinetic energy at the start; `unit` is an energy of the
  /// scene, `level` is E₀. If the start is an inflection up to rounding, all frequencies are 0.
  FrequencyFloor(double start, double force, double kinetic, double unit, double level)
      : start_(start), level_(level), reference_(std::max(kinetic, force / (2 * start))) {
    constexpr double none = 1e-9;
    follows_ = start > none * force / (2 * std::max(kinetic, unit));
  }

  /// ω² at a place with ‖g⁻¹V″‖ = `bent` and V = `potential`.
  double operator()(double bent, double potential) const {
    if (!follows_) return 0;
    const double kinetic = std::max(level_ - potential, 0.0), part = kinetic / (kinetic + reference_);
    const double floor = 0.5 * start_ * part * std::sqrt(part);
    return bent < 2 * floor ? floor + bent * bent / (4 * floor) : bent;
  }

 private:
  double start_ = 0, level_ = 0, reference_ = 0;
  bool follows_ = false;
};

}  // namespace least
