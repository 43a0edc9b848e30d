// A local frequency that does not vanish where a motion goes through an inflection of V: there V″ says nothing of how
// long a step may be, and steps that follow it would become as long as one likes. With ω² = ‖g⁻¹V″‖,
//   ω² as it is where it exceeds 2F, else F + ω⁴/4F, which is as smooth,
//   F = ½ ω₀² (K/(K + K₀))^{3/2}, K = E₀ − V
// where ω₀ is that of the start and K₀ the larger one of its kinetic energy and of ∇V·g⁻¹∇V/2ω₀², the one that a motion
// from rest comes to. A harmonic motion keeps its own. A function of the place alone: steps stay reversible.
#pragma once

#include <algorithm>
#include <cmath>

namespace least {

class FrequencyFloor {
 public:
  FrequencyFloor() = default;
  /// Of a start with this ω₀², ∇V·g⁻¹∇V and kinetic energy; `unit`: an energy of the scene. Where the start is an
  /// inflection but for rounding there is nothing to follow: all frequencies are 0.
  FrequencyFloor(double start, double force, double kinetic, double unit, double level)
      : start_(start), level_(level), reference_(std::max(kinetic, force / (2 * start))) {
    constexpr double none = 1e-9;
    follows_ = start > none * force / (2 * std::max(kinetic, unit));
  }

  /// ω² where ‖g⁻¹V″‖ and V are these.
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
