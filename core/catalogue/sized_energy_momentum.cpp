#include "core/catalogue/sized_energy_momentum.hpp"

#include <cmath>

namespace least {

template <class T>
SizedEnergyMomentum<T>::SizedEnergyMomentum(const text::SizedScene& scene, const EnergyMomentum& scheme, const T& level)
    : scene_(&scene),
      level_(level),
      step_(scheme.step),
      nominal_(scene, SizedPath::straight, Composition::none, scheme.step, 2 * scene.coordinates),
      matrix_(std::make_shared<PlaceMatrix>(scene)),
      start_(2 * scene.coordinates),
      velocity_(scene.coordinates),
      place_(scene.coordinates),
      pushed_(scene.coordinates),
      wrong_(scene.coordinates),
      border_(scene.coordinates),
      along_(scene.coordinates),
      moved_(scene.coordinates),
      v_(scene.coordinates),
      y_(scene.coordinates),
      slope_(scene.coordinates) {}

template <class T>
StepStatus SizedEnergyMomentum<T>::step(T* x, T& h) noexcept {
  const std::size_t n = velocity_.size();
  if (!solve(x) || !ride_along(x)) {
    const StepStatus status = nominal_.step(x, 0, step_);
    h = T(step_);
    if (status == StepStatus::ok) ++fallbacks_;
    return status;
  }
  for (std::size_t i = 0; i < n; ++i) y_[i] = x[i] + 0.5 * length_ * v_[i];
  scene_->gradient.evaluate(y_.data(), 0.0, slope_.data());
  ++work_.forces;
  for (std::size_t i = 0; i < n; ++i) {
    x[i] = x[i] + length_ * v_[i];
    x[n + i] = x[n + i] - length_ * slope_[i];
  }
  h = length_;
  return StepStatus::ok;
}

/// Newton's method from h₀ for v and (h/h₀)², since E_d is nearly linear in h².
template <class T>
bool SizedEnergyMomentum<T>::solve(const T* x) {
  constexpr int most_iterations = 20;
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  const double small = std::pow(epsilon, 0.75), level = plain_number(level_);
  const std::size_t n = velocity_.size();
  for (std::size_t i = 0; i < 2 * n; ++i) start_[i] = plain_number(x[i]);
  const double scale = guess();
  double grain = std::numeric_limits<double>::min();
  for (std::size_t i = 0; i < n; ++i) grain += 8 * epsilon * std::abs(start_[i]);
  grain /= std::abs(step_);
  double square = 1;    // (h/h₀)²
  bool outworn = true;  // the matrix, which is kept for several rounds
  double before = std::numeric_limits<double>::infinity();
  for (int k = 0; k < most_iterations; ++k) {
    ++work_.iterations;
    const double excess = look();
    if (outworn && !prepare()) return false;
    const double of_square = 2 * square / h_ * eliminate(excess);
    double change = 0;
    for (std::size_t i = 0; i < n; ++i) {
      change += std::abs(wrong_[i]);
      velocity_[i] -= wrong_[i];
    }
    square -= of_square;
    if (!(square > 0 && square < 64 * most)) return false;  // also if it is NaN
    h_ = step_ * std::sqrt(square);
    const double changed = change / scale + std::abs(of_square) / square;
    outworn = changed > 1e-2 * before;
    before = changed;
    // An energy error at round-off does not determine h any further.
    const bool kept = std::abs(excess) <= 4 * epsilon * (size_ + std::abs(level));
    if (change <= small * scale + grain && (kept || std::abs(of_square) <= small * square))
      return square >= 1 / most && square <= most;
  }
  return false;
}

/// guess sets v to that after half a kick; returns the size of velocities.
template <class T>
double SizedEnergyMomentum<T>::guess() {
  const std::size_t n = velocity_.size();
  const double *const q = start_.data(), *const p = q + n;
  double scale = 0;
  h_ = step_;
  scene_->velocity(p, velocity_.data());
  for (std::size_t i = 0; i < n; ++i) {
    scale += std::abs(velocity_[i]);
    place_[i] = q[i] + 0.5 * h_ * velocity_[i];
  }
  scene_->gradient.evaluate(place_.data(), 0.0, wrong_.data());
  ++work_.forces;
  for (std::size_t i = 0; i < n; ++i) pushed_[i] = p[i] - 0.5 * h_ * wrong_[i];
  scene_->velocity(pushed_.data(), velocity_.data());
  for (std::size_t i = 0; i < n; ++i) scale += std::abs(velocity_[i]);
  return scale;
}

template <class T>
double SizedEnergyMomentum<T>::look() {
  const std::size_t n = velocity_.size();
  const double *const q = start_.data(), *const p = q + n, half = 0.5 * h_;
  for (std::size_t i = 0; i < n; ++i) {
    place_[i] = q[i] + half * velocity_[i];
    along_[i] = Slope(place_[i], {velocity_[i]});
  }
  scene_->gradient.evaluate(along_.data(), 0.0, moved_.data());
  double potential = 0, twice = 0, power = 0;
  scene_->potential_beside_constant().evaluate(place_.data(), 0.0, &potential);
  ++work_.forces;
  for (std::size_t i = 0; i < n; ++i) {
    const double lowered = matrix_->times_mass(i, velocity_.data()), slope = moved_[i].value;
    twice += velocity_[i] * lowered;
    power += velocity_[i] * slope;
    pushed_[i] = lowered + half * slope;
    wrong_[i] = pushed_[i] - p[i];
    border_[i] = 0.5 * (slope + half * moved_[i].slope[0]);
  }
  size_ = 0.5 * twice + std::abs(potential);
  of_length_ = 0.5 * power;
  return 0.5 * twice + potential - plain_number(level_);
}

template <class T>
bool SizedEnergyMomentum<T>::prepare() {
  const double beta = 0.25 * h_ * h_, none = 0;
  return matrix_->factor(place_.data(), &beta, &none, PlaceMatrix::Curvature::of_each, work_);
}

template <class T>
double SizedEnergyMomentum<T>::eliminate(double excess) {
  matrix_->solve(wrong_.data());
  matrix_->solve(border_.data());
  double right = excess, left = of_length_;
  for (std::size_t i = 0; i < wrong_.size(); ++i) {
    right -= pushed_[i] * wrong_[i];
    left -= pushed_[i] * border_[i];
  }
  const double change = right / left;
  for (std::size_t i = 0; i < wrong_.size(); ++i) wrong_[i] -= change * border_[i];
  return change;
}

template <class T>
bool SizedEnergyMomentum<T>::ride_along([[maybe_unused]] const T* x) {
  const std::size_t n = velocity_.size();
  if constexpr (std::is_same_v<T, double>) {
    v_ = velocity_;
    length_ = h_;
  } else {
    look();
    if (!prepare()) return false;
    for (std::size_t i = 0; i < n; ++i) along_[i] = Slope(place_[i], x[i].slope);
    double excess = level_.slope[0];
    for (std::size_t i = 0; i < n; ++i) excess -= moved_[i].value * x[i].slope[0];
    scene_->gradient.evaluate(along_.data(), 0.0, moved_.data());
    for (std::size_t i = 0; i < n; ++i) wrong_[i] = x[n + i].slope[0] - 0.5 * h_ * moved_[i].slope[0];
    const double longer = eliminate(excess);
    if (!std::isfinite(longer)) return false;
    for (std::size_t i = 0; i < n; ++i) v_[i] = Slope(velocity_[i], {wrong_[i]});
    length_ = Slope(h_, {longer});
  }
  return true;
}

template <class T>
double SizedEnergyMomentum<T>::discrete_energy(const RunState& a, const RunState& b) const {
  const std::size_t n = velocity_.size();
  std::vector<double> q(n), p(n), v(n);
  for (std::size_t i = 0; i < n; ++i) {
    q[i] = 0.5 * (a[i] + b[i]);
    p[i] = 0.5 * (a[n + i] + b[n + i]);
  }
  scene_->velocity(p.data(), v.data());
  double energy = 0;
  scene_->potential.evaluate(q.data(), 0.0, &energy);
  for (std::size_t i = 0; i < n; ++i) energy += 0.5 * p[i] * v[i];
  return energy;
}

template class SizedEnergyMomentum<double>;
template class SizedEnergyMomentum<Slope>;

}  // namespace least
