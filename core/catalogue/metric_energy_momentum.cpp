#include "core/catalogue/metric_energy_momentum.hpp"

#include <cmath>

namespace least {

template <class T>
MetricEnergyMomentum<T>::MetricEnergyMomentum(const text::SizedScene& scene, const EnergyMomentum& scheme,
                                              const T& level)
    : scene_(&scene),
      level_(level),
      step_(scheme.step),
      n_(scene.coordinates),
      nominal_(scene, SizedPath::straight, Composition::none),
      newton_(std::make_shared<SmallNewton<T>>(n_ + 1)),
      middle_(scene),
      row_(scene),
      z_(n_ + 1),
      p_(n_),
      start_(2 * n_) {}

template <class T>
StepStatus MetricEnergyMomentum<T>::step(T* x, T& h) noexcept {
  if (solve(x)) {
    h = look(x, z_.data(), middle_);
    ++work_.forces;
    for (std::size_t i = 0; i < n_; ++i) {
      x[i] = x[i] + h * z_[i];
      x[n_ + i] = x[n_ + i] + h * middle_.force(i);
    }
    return StepStatus::ok;
  }
  const StepStatus status = nominal_.step(x, 0, step_);
  h = T(step_);
  if (status == StepStatus::ok) ++fallbacks_;
  return status;
}

template <class T>
template <class A, class U>
U MetricEnergyMomentum<T>::look(const A* x, const U* z, LagrangianLook<U>& middle) const {
  using least::sqrt;
  const U h = step_ * sqrt(z[n_]);
  middle.look([&](std::size_t i) { return U(x[i] + 0.5 * h * z[i]); }, [&](std::size_t i) { return z[i]; });
  return h;
}

template <class T>
template <class A, class U>
void MetricEnergyMomentum<T>::equations(const A* x, const A& level, const U* z, LagrangianLook<U>& middle,
                                        U* wrong) const {
  const U h = look(x, z, middle);
  for (std::size_t i = 0; i < n_; ++i) wrong[i] = middle.momentum(i) - 0.5 * h * middle.force(i) - x[n_ + i];
  wrong[n_] = 0.5 * middle.twice_kinetic() + middle.potential() - level;
}

/// Newton's method from h₀ for v and (h/h₀)², since E_d is nearly linear in h².
template <class T>
bool MetricEnergyMomentum<T>::solve(const T* x) {
  constexpr int most_iterations = 20;
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  const double level = plain_number(level_);
  const double scale = plain_number(guess(x));
  double grain = std::numeric_limits<double>::min();
  for (std::size_t i = 0; i < 2 * n_; ++i) start_[i] = plain_number(x[i]);
  for (std::size_t i = 0; i < n_; ++i) grain += 8 * epsilon * std::abs(start_[i]);
  grain /= std::abs(step_);
  newton_->begin();
  for (int k = 0, late = late_rounds<T>; k < most_iterations; ++k) {
    ++work_.forces;
    ++work_.iterations;
    T excess;
    const auto in_numbers = [&](const T* z, T* wrong) {
      equations(x, level_, z, middle_, wrong);
      excess = wrong[n_];
    };
    const auto in_rows = [&](const FewDirections* z, FewDirections* wrong) {
      equations(start_.data(), level, z, row_, wrong);
    };
    if (!newton_->look(z_.data(), in_numbers, in_rows)) return false;
    const double size = plain_number(T(0.5 * middle_.twice_kinetic())) + std::abs(plain_number(middle_.potential()));
    double change = 0;
    for (std::size_t i = 0; i <= n_; ++i) {
      if (i < n_) change += std::abs(plain_number(newton_->update[i]));
      z_[i] = z_[i] - newton_->update[i];
    }
    const double square = plain_number(z_[n_]);
    if (!(square > 0 && square < 64 * most)) return false;  // also if it is NaN
    // An energy error at round-off does not determine h any further.
    const bool kept = std::abs(plain_number(excess)) <= 4 * epsilon * (size + std::abs(level));
    // These are tests for v; (h/h₀)² is tested by the energy.
    const double length = std::abs(plain_number(newton_->update[n_])), left = newton_->left(change + scale * length);
    const bool found = change <= small_part(scale) + grain && left <= epsilon * scale + grain;
    if (!((found || newton_->is_rounding(scale + grain / epsilon)) && (kept || length <= small_part(square)))) continue;
    if (late-- == 0) return square >= 1 / most && square <= most;
  }
  return false;
}

/// guess sets v to that after half a kick; returns the size of velocities.
template <class T>
T MetricEnergyMomentum<T>::guess(const T* x) {
  using least::abs;
  T scale(0);
  const auto see = [&](const T* p) {
    raise(*scene_, x, p, z_.data());
    for (std::size_t i = 0; i < n_; ++i) scale = scale + abs(z_[i]);
  };
  z_[n_] = T(1);
  see(x + n_);
  const T h = look(x, z_.data(), middle_);
  ++work_.forces;
  for (std::size_t i = 0; i < n_; ++i) p_[i] = x[n_ + i] + 0.5 * h * middle_.force(i);
  see(p_.data());
  return scale;
}

template <class T>
double MetricEnergyMomentum<T>::discrete_energy(const RunState& a, const RunState& b) const {
  std::vector<double> x(2 * n_);
  for (std::size_t i = 0; i < 2 * n_; ++i) x[i] = 0.5 * (a[i] + b[i]);
  return hamiltonian_at(*scene_, x.data());
}

template class MetricEnergyMomentum<double>;
template class MetricEnergyMomentum<Slope>;

}  // namespace least
