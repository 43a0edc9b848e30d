// adaptive_verlet on scenes H = ½ pᵀM⁻¹p + V(q) whose size is known only at run time.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/catalogue/frequency_floor.hpp"
#include "core/memory_budget.hpp"
#include "core/number/asked_by_thread.hpp"
#include "core/run/run_state.hpp"
#include "core/scheme.hpp"
#include "core/schemes/adaptive_verlet.hpp"
#include "core/text/sized_scene.hpp"

namespace least {

/// SizedAdaptiveVerlet is as AdaptiveVerletStepper (core/schemes/adaptive_verlet.hpp), but if a step fails, the state
/// is undefined.
class SizedAdaptiveVerlet {
 public:
  SizedAdaptiveVerlet(const text::SizedScene& scene, const AdaptiveVerlet& scheme, const RunState& x, double energy)
      : scene_(&scene),
        energy_(energy),
        per_unit_(2 / scheme.unit_energy),
        half_(0.5 * scheme.step),
        slope_(scene.coordinates),
        velocity_(slope_) {
    if (scheme.monitor == Monitor::frequency) {
      curvature_ = &scene.curvature();
      if (scene.has_full_mass()) {
        const std::size_t entries = scene.coordinates * scene.coordinates;
        held_ = HeldByThread::take_soon(entries * sizeof(double));
        bent_.resize(entries);
      }
    }
    const double* const q = x.numbers.data();
    scene.gradient.evaluate(q, 0.0, slope_.data());
    if (curvature_) {
      scene.velocity(slope_.data(), velocity_.data());
      double force = 0;
      for (std::size_t i = 0; i < slope_.size(); ++i) force += slope_[i] * velocity_[i];
      floor_ = {bent_at(q), force, energy - potential_at(q), scheme.unit_energy, energy};
    }
    const double start = monitor(q);
    scale_ = start <= 0 ? -1 : 1 / start;
    ++work_.forces;
  }

  StepStatus step(RunState& x) noexcept {
    const std::size_t n = slope_.size();
    double *const q = x.numbers.data(), *const p = q + n;
    const auto kick = [&](double h) {
      for (std::size_t i = 0; i < n; ++i) p[i] -= h * slope_[i];
    };
    const auto drift = [&](double h) {
      scene_->velocity(p, velocity_.data());
      for (std::size_t i = 0; i < n; ++i) q[i] += h * velocity_[i];
    };
    double dt = half_ / density_;
    kick(dt);
    drift(dt);
    const double rate = scale_ < 0 ? 1 : scale_ * monitor(q);
    if (curvature_ && !AskedByThread::goes_on()) return StepStatus::solver_failed;
    const double density = 2 * rate - density_, after = half_ / density;
    drift(after);
    scene_->gradient.evaluate(q, 0.0, slope_.data());
    work_.forces += 2;  // one of them by the monitor at the middle
    kick(after);
    dt += after;
    // If the density oscillates by more than half of U about it, the recursion no longer follows the monitor.
    if (!(5 * density >= 3 * density_ && 3 * density <= 5 * density_)) return StepStatus::singular;
    x.t += dt;
    density_ = density;
    return StepStatus::ok;
  }
  const Work& work() const { return work_; }

 private:
  double monitor(const double* q) {
    const double potential = potential_at(q);
    return std::sqrt(curvature_ ? floor_(bent_at(q), potential) : 1 + per_unit_ * (energy_ - potential));
  }
  double potential_at(const double* q) const {
    double potential;
    scene_->potential.evaluate(q, 0.0, &potential);
    return potential;
  }
  /// bent_at returns the Frobenius norm of g⁻¹V″.
  double bent_at(const double* q) {
    double sum = 0;
    const auto see = [&](auto&& take) { curvature_->evaluate(scene_->gradient, q, 0.0, take); };
    if (bent_.empty()) {
      const auto inverse_mass = scene_->inverse_mass();
      see([&](std::size_t row, std::size_t, double value) {
        const double entry = inverse_mass[row] * value;
        sum += entry * entry;
      });
      return std::sqrt(sum);
    }
    std::ranges::fill(bent_, 0.0);
    see([&](std::size_t row, std::size_t column, double value) {
      for (const auto& [i, share] : scene_->inverse_mass_matrix()[row])
        bent_[column * slope_.size() + i] += share * value;
    });
    for (const double entry : bent_) sum += entry * entry;
    return std::sqrt(sum);
  }

  const text::SizedScene* scene_;
  const tape::SparseJacobian* curvature_ = nullptr;  ///< V″ of the scene; null if the monitor is the arclength
  FrequencyFloor floor_;
  double energy_;                   ///< E₀
  double per_unit_;                 ///< 2/ε
  double half_;                     ///< h/2
  double scale_ = 0, density_ = 1;  ///< 1/U(q₀) unscaled, or −1 where U(q₀) is 0; ρ
  std::vector<double> slope_;       ///< ∇V at the state's q
  std::vector<double> velocity_;
  Held held_ = HeldByThread::take(0);
  std::vector<double> bent_;  ///< g⁻¹V″, column-major, if g is not diagonal
  Work work_;
};

}  // namespace least
