#include "core/catalogue/metric_clock.hpp"

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "core/catalogue/metric_step.hpp"
#include "core/catalogue/sized_clock_tangents.hpp"
#include "core/run/self_timed.hpp"

namespace least {
namespace {

/// MetricMidpoint takes steps in numbers T, on components (q, p) in one contiguous list. It solves for u = (q₁ − q₀)/σ:
/// with D = E₀ − V + κ at m = q₀ + (σ/2) u and v = D u, g(m) v is the mean of p₀ and p₁.
template <class T>
class MetricMidpoint {
 public:
  MetricMidpoint(const text::SizedScene& scene, const TimeTransformed& scheme, const T& energy)
      : scene_(&scene),
        scheme_(scheme),
        weights_(&Weights<double>::of(scheme_.composition)),
        n_(scene.coordinates),
        newton_(std::make_shared<SmallNewton<T>>(n_)),
        look_(scene),
        row_(scene),
        u_(n_),
        p_(n_),
        kick_(n_),
        slope_(n_),
        row_kick_(n_),
        row_slope_(n_),
        place_(n_),
        row_place_(n_),
        x_(2 * n_) {
    set_level(energy);
  }
  void set_level(const T& energy) {
    const bool kepler = std::isnan(scheme_.kappa);
    level_ = kepler ? T(0) : T(energy + scheme_.kappa);
    kappa_ = kepler ? T(-energy) : T(scheme_.kappa);
  }
  const TimeTransformed& scheme() const { return scheme_; }

  /// 1/(K + κ)
  T pace(const T* x) const {
    T potential;
    scene_->potential.evaluate(x, 0.0, &potential);
    return 1 / (hamiltonian_at(*scene_, x) - potential + kappa_);
  }
  const T& strain() const { return strain_; }
  int stages() const { return weights_->stages; }

  /// Moves the state by σ in the parameter; writes the time that this takes.
  StepStatus move(T* state, const T& sigma, T& time, Work& work) {
    x_.assign(state, state + 2 * n_);
    T elapsed(0);
    for (std::size_t i = 0; i < static_cast<std::size_t>(weights_->stages); ++i)
      if (const auto status = stage(x_.data(), sigma * weights_->gamma[i], elapsed, work); status != StepStatus::ok)
        return status;
    if (!(elapsed * sigma > T(0))) return StepStatus::singular;
    std::ranges::copy(x_, state);
    time = elapsed;
    return StepStatus::ok;
  }

 private:
  template <class U>
  struct Middle {
    U gap, ratio;  ///< D, D/(K + κ)
  };
  /// Evaluates the middle of a step; writes (h/2)F + c to `kick`.
  template <class A, class U>
  Middle<U> middle(const A* x, const A& level, const A& kappa, const A& half, const U* u, LagrangianLook<U>& look,
                   std::vector<U>& place, std::vector<U>& slope, std::vector<U>& kick) const {
    for (std::size_t i = 0; i < n_; ++i) place[i] = x[i] + half * u[i];
    const U gap = level - scene_->potential_with_gradient(place.data(), 0.0, slope.data());
    look.look([&](std::size_t i) { return place[i]; }, [&](std::size_t i) { return U(gap * u[i]); });
    const U slow = 0.5 * look.twice_kinetic() + kappa;  // D − slow = E₀ − E_d
    const U correction = (gap - slow) / gap, half_step = half / gap;
    for (std::size_t i = 0; i < n_; ++i) kick[i] = half_step * (look.force(i) + correction * slope[i]);
    return {gap, gap / slow};
  }

  StepStatus stage(T* x, const T& sigma, T& elapsed, Work& work) {
    using least::abs;
    constexpr int most_iterations = 50;
    constexpr double epsilon = std::numeric_limits<double>::epsilon();
    const T half = 0.5 * sigma;
    const auto in_numbers = [&](const T* u) {
      return middle(x, level_, kappa_, half, u, look_, place_, slope_, kick_);
    };
    // The guess: the velocity at the start, then that after half a kick.
    double scale = 0, grain = std::numeric_limits<double>::min();
    const auto see = [&](const T* p, const T& factor) {
      raise(*scene_, x, p, u_.data());
      for (T& c : u_) {
        c = factor * c;
        scale += std::abs(plain_number(c));
      }
    };
    see(x + n_, pace(x));
    const auto begin = in_numbers(u_.data());
    ++work.forces;
    for (std::size_t i = 0; i < n_; ++i) p_[i] = x[n_ + i] + kick_[i];
    see(p_.data(), 1 / begin.gap);
    start_.resize(2 * n_);
    for (std::size_t i = 0; i < 2 * n_; ++i) start_[i] = plain_number(x[i]);
    for (std::size_t i = 0; i < n_; ++i) grain += 8 * epsilon * std::abs(start_[i]);
    grain /= std::abs(plain_number(sigma));
    const double level = plain_number(level_), kappa = plain_number(kappa_), plain_half = plain_number(half);
    newton_->begin();
    for (int k = 0, late = late_rounds<T>;; ++k) {
      if (k == most_iterations) return StepStatus::solver_failed;
      ++work.forces;
      ++work.iterations;
      const bool known = newton_->look(
          u_.data(),
          [&](const T* u, T* wrong) {
            in_numbers(u);
            for (std::size_t i = 0; i < n_; ++i) wrong[i] = look_.momentum(i) - kick_[i] - x[n_ + i];
          },
          [&](const FewDirections* u, FewDirections* wrong) {
            middle(start_.data(), level, kappa, plain_half, u, row_, row_place_, row_slope_, row_kick_);
            for (std::size_t i = 0; i < n_; ++i) wrong[i] = row_.momentum(i) - row_kick_[i] - start_[n_ + i];
          });
      if (!known) return StepStatus::solver_failed;
      double change = 0;
      for (std::size_t i = 0; i < n_; ++i) {
        change += std::abs(plain_number(newton_->update[i]));
        u_[i] = u_[i] - newton_->update[i];
      }
      if (!(change < std::numeric_limits<double>::max())) return StepStatus::solver_failed;
      const double left = newton_->left(change);
      const bool small = change <= small_part(scale) + grain && left <= epsilon * scale + grain;
      if ((small || newton_->is_rounding(scale + grain / epsilon)) && late-- == 0) break;
    }
    const auto at = in_numbers(u_.data());
    ++work.forces;
    for (std::size_t i = 0; i < n_; ++i) {
      x[i] = x[i] + sigma * u_[i];
      x[n_ + i] = x[n_ + i] + 2.0 * kick_[i];
    }
    elapsed = elapsed + sigma / at.gap;
    const T square = at.ratio * at.ratio, off = abs(square - 1.0);
    if (off > strain_) strain_ = off;
    return at.gap > T(0) && at.ratio > T(0) && near_level(square, T(1)) ? StepStatus::ok : StepStatus::singular;
  }

  const text::SizedScene* scene_;
  TimeTransformed scheme_;  ///< keeps the weights
  const Weights<double>* weights_;
  std::size_t n_;
  T level_, kappa_;                         ///< E₀ + κ and κ
  T strain_{};                              ///< the largest |(D/(K + κ))² − 1| of a stage
  std::shared_ptr<SmallNewton<T>> newton_;  ///< shared by copies: it keeps nothing from one step to the next
  LagrangianLook<T> look_;
  LagrangianLook<FewDirections> row_;
  std::vector<T> u_, p_, kick_, slope_;
  std::vector<FewDirections> row_kick_, row_slope_;
  std::vector<T> place_;
  std::vector<FewDirections> row_place_;
  std::vector<T> x_;
  std::vector<double> start_;
};

/// MetricKernel is the kernel in the form that TransformedStepper needs.
class MetricKernel : public MetricMidpoint<double> {
 public:
  using Memory = NoMemory;
  static constexpr bool reads_time = false;
  using MetricMidpoint<double>::MetricMidpoint;

  void settle(const RunState&, NoMemory) {}
  static NoMemory memory() { return {}; }
  double pace(const RunState& x) const { return MetricMidpoint<double>::pace(x.numbers.data()); }
  StepStatus move(RunState& x, double sigma, double& time, Work& work) {
    return MetricMidpoint<double>::move(x.numbers.data(), sigma, time, work);
  }
};

struct ClockedMetric {
  TimeTransformed chosen;
  const text::SizedScene* scene;

  static constexpr bool own_clock = true;
  template <class P>
  double level(const P&, const RunState& x) const {
    return hamiltonian_at(*scene, x.numbers.data());
  }
  template <class P>
  TransformedStepper<MetricKernel, RunState> bind(const P&, const RunState&, double energy) const {
    return {MetricKernel(*scene, chosen, energy), chosen.sigma};
  }
};

/// VariedClock takes steps in dual numbers, for tangents.
struct VariedClock {
  MetricMidpoint<Slope> midpoint;

  void begin(const Slope*, const Slope& level) { midpoint.set_level(level); }
  StepStatus step(Slope* x, Slope& h) {
    Work work;
    return midpoint.move(x, Slope(midpoint.scheme().sigma), h, work);
  }
};

}  // namespace

std::unique_ptr<Integrator> bind_metric_clock(const RunBackend& backend, const text::SizedScene& scene,
                                              const TimeTransformed& scheme, const RunState& x, double end) {
  struct Problem {};
  return std::make_unique<SelfTimedIntegrator<Problem, ClockedMetric, RunState>>(backend, Problem{},
                                                                                 ClockedMetric{scheme, &scene}, x, end);
}

StepTangents tangents_of_metric_clock(const text::SizedScene& scene, const TimeTransformed& scheme,
                                      const Request& request) {
  return tangents_by_clock(request, {scene.coordinates, scene.components},
                           VariedClock{MetricMidpoint<Slope>(scene, scheme, Slope(0))},
                           energy_of_start(scene, request.scene->initial.data()));
}

}  // namespace least
