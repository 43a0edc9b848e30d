#include "core/catalogue/sized_clocks.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/memory_budget.hpp"
#include "core/number/asked_by_thread.hpp"
#include "core/run/self_timed.hpp"

namespace least {
namespace {

/// A scene as its integrator sees it.
struct ClockedScene {
  const RunBackend* backend;
  const text::SizedScene* scene;

  /// K + V, of which schemes take the level of a run.
  double level(const RunState& x) const { return backend->table().mechanical_energy(x); }
};

/// As AdaptiveVerletStepper.
class SizedAdaptiveVerlet {
 public:
  SizedAdaptiveVerlet(const text::SizedScene& scene, const AdaptiveVerlet& scheme, const RunState& x, double energy)
      : scene_(&scene),
        monitor_(scheme.monitor),
        energy_(energy),
        per_unit_(2 / scheme.unit_energy),
        half_(0.5 * scheme.step),
        slope_(scene.coordinates),
        next_(slope_),
        velocity_(slope_),
        y_(x.numbers.begin(), x.numbers.end()) {
    if (scene.has_full_mass() && monitor_ == Monitor::frequency) {
      const std::size_t entries = scene.coordinates * scene.coordinates;
      held_ = HeldByThread::take_soon(entries * sizeof(double));
      curvature_.resize(entries);
    }
    scene.gradient.evaluate(y_.data(), 0.0, slope_.data());
    const double start = monitor();
    scale_ = start <= 0 ? -1 : 1 / start;
    ++work_.forces;
  }

  StepStatus step(RunState& x) noexcept {
    std::copy(x.numbers.begin(), x.numbers.end(), y_.begin());
    double dt = half_ / density_;
    kick(dt, slope_);
    drift(dt);
    const double rate = scale_ < 0 ? 1 : scale_ * monitor();
    if (monitor_ == Monitor::frequency && !AskedByThread::goes_on()) return StepStatus::solver_failed;
    const double density = 2 * rate - density_, after = half_ / density;
    drift(after);
    scene_->gradient.evaluate(y_.data(), 0.0, next_.data());
    work_.forces += 2;  // the monitor looked at the middle
    kick(after, next_);
    dt += after;
    // Where the density swings by more than half of U about it, the recursion follows nothing any more.
    if (!(5 * density >= 3 * density_ && 3 * density <= 5 * density_)) return StepStatus::singular;
    std::copy(y_.begin(), y_.end(), x.numbers.begin());
    x.t += dt;
    density_ = density;
    std::swap(slope_, next_);
    return StepStatus::ok;
  }
  const Work& work() const { return work_; }

 private:
  double monitor() {
    if (monitor_ == Monitor::frequency) return std::sqrt(local_frequency_squared());
    double potential;
    scene_->potential.evaluate(y_.data(), 0.0, &potential);
    return std::sqrt(1 + per_unit_ * (energy_ - potential));
  }
  /// Frobenius' norm of g⁻¹V″.
  double local_frequency_squared() {
    double sum = 0;
    const auto see = [&](auto&& take) { scene_->curvature().evaluate(scene_->gradient, y_.data(), 0.0, take); };
    if (curvature_.empty()) {
      see([&](std::size_t row, std::size_t, double value) {
        const double entry = scene_->inverse_mass()[row] * value;
        sum += entry * entry;
      });
      return std::sqrt(sum);
    }
    std::ranges::fill(curvature_, 0.0);
    see([&](std::size_t row, std::size_t column, double value) {
      for (const auto& [i, share] : scene_->inverse_mass_matrix()[row])
        curvature_[column * slope_.size() + i] += share * value;
    });
    for (const double entry : curvature_) sum += entry * entry;
    return std::sqrt(sum);
  }
  void kick(double h, const std::vector<double>& slope) {
    double* const p = y_.data() + slope.size();
    for (std::size_t i = 0; i < slope.size(); ++i) p[i] -= h * slope[i];
  }
  void drift(double h) {
    scene_->velocity(y_.data() + velocity_.size(), velocity_.data());
    for (std::size_t i = 0; i < velocity_.size(); ++i) y_[i] += h * velocity_[i];
  }

  const text::SizedScene* scene_;
  Monitor monitor_;
  double energy_;                   ///< E₀
  double per_unit_;                 ///< 2/ε
  double half_;                     ///< h/2
  double scale_ = 0, density_ = 1;  ///< 1/U(q₀) unscaled, or −1 where U(q₀) is 0; ρ
  std::vector<double> slope_;       ///< ∇V at the state's q
  std::vector<double> next_, velocity_, y_;
  Held held_ = HeldByThread::take(0);
  std::vector<double> curvature_;  ///< g⁻¹V″ column by column, where g is not diagonal
  Work work_;
};

struct ClockedAdaptiveVerlet {
  AdaptiveVerlet chosen;

  static constexpr bool own_clock = true, remembers = true;
  static double level(const ClockedScene& problem, const RunState& x) { return problem.level(x); }
  SizedAdaptiveVerlet bind(const ClockedScene& problem, const RunState& x, double energy) const {
    return {*problem.scene, chosen, x, energy};
  }
};

/// Of a scheme that is bound to a scene the integrator.
template <class Scheme>
std::unique_ptr<Integrator> clocked(const RunBackend& backend, const text::SizedScene& scene, const Scheme& scheme,
                                    const RunState& x, double end) {
  const ClockedScene problem{&backend, &scene};
  return std::make_unique<SelfTimedIntegrator<ClockedScene, Scheme, RunState>>(backend, problem, scheme, x, end);
}

}  // namespace

std::unique_ptr<Integrator> bind_clock(const RunBackend& backend, const text::SizedScene& scene,
                                       const AdaptiveVerlet& scheme, const RunState& x, double end) {
  return clocked(backend, scene, ClockedAdaptiveVerlet{scheme}, x, end);
}

}  // namespace least
