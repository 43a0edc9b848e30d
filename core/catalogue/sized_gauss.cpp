#include "core/catalogue/sized_gauss.hpp"

#include <cmath>

#include "core/number/linear.hpp"
#include "core/schemes/damping_pole.hpp"

namespace least {

template <class T>
SizedGauss<T>::SizedGauss(const text::SizedScene& scene, const ContactGauss& scheme, std::size_t components)
    : scene_(&scene),
      scheme_(scheme),
      rule_(StageRule::gauss(scheme.stages)),
      acts_(scene.acting && components == scene.components),
      momentum_(scene.coordinates),
      velocity_(scene.coordinates),
      guess_(rule_.stages * scene.coordinates),
      place_(guess_.size()),
      slope_(guess_.size()),
      solver_(std::make_shared<PlaceSolver>(scene, rule_.stages)) {}

/// scales solves P_s′ = α(t) P_s: σ_i − h Σ_j a_ij α_j σ_j = 1.
template <class T>
auto SizedGauss<T>::scales(const Few& alpha, double h) const -> Few {
  const std::size_t stages = rule_.stages;
  Square matrix{};
  for (std::size_t i = 0; i < stages; ++i)
    for (std::size_t j = 0; j < stages; ++j)
      matrix[i * stages + j] = (i == j ? 1 : 0) - h * rule_.of_places[i][j] * alpha[j];
  detail::invert(stages, matrix.data());
  Few scale{};
  for (std::size_t i = 0; i < stages; ++i)
    for (std::size_t j = 0; j < stages; ++j) scale[i] += matrix[i * stages + j];
  return scale;
}

template <class T>
StepStatus SizedGauss<T>::step(T* x, double t, double h) noexcept {
  const std::size_t n = scene_->coordinates, stages = rule_.stages;
  const auto& a = rule_.of_places;
  T* const p = x + n;
  Few time{}, alpha{};
  for (std::size_t i = 0; i < stages; ++i) {
    time[i] = t + rule_.node[i] * h;
    alpha[i] = scene_->damping_at(time[i]);
  }
  const Few scale = scales(alpha, h);
  double end = 1;
  for (std::size_t i = 0; i < stages; ++i) end += h * rule_.weight[i] * scale[i] * alpha[i];
  if (!(std::abs(end) > least_denominator)) return StepStatus::singular;

  Square beta{};
  Few of_slope{};  // effect of ∇V at each stage on the end of the step, in units of h²
  double of_start = 0;
  scene_->velocity(p, velocity_.data());
  for (std::size_t i = 0; i < stages; ++i) {
    double drift = 0;
    for (std::size_t j = 0; j < stages; ++j) {
      drift += a[i][j] / scale[j];
      for (std::size_t k = 0; k < stages; ++k)
        beta[i * stages + k] += h * h * a[i][j] * a[j][k] * (scale[k] / scale[j]);
      of_slope[i] += rule_.weight[j] * a[j][i] * (scale[i] / scale[j]);
    }
    of_start += rule_.weight[i] / scale[i];
    for (std::size_t k = 0; k < n; ++k) guess_[i * n + k] = x[k] + (h * drift) * velocity_[k];
  }
  if (const auto status = solver_->solve(guess_.data(), beta.data(), time.data(), place_, slope_, work_);
      status != StepStatus::ok)
    return status;
  if (acts_) move_action(x[2 * n], p, time, alpha, scale, h);
  for (std::size_t k = 0; k < n; ++k) {
    T pulled(0), kicked(0);
    for (std::size_t i = 0; i < stages; ++i) {
      pulled = pulled + (rule_.weight[i] * scale[i]) * slope_[i * n + k];
      kicked = kicked + of_slope[i] * slope_[i * n + k];
    }
    momentum_[k] = of_start * p[k] - h * kicked;
    p[k] = (p[k] - h * pulled) / end;
  }
  scene_->velocity(momentum_.data(), velocity_.data());
  for (std::size_t k = 0; k < n; ++k) x[k] = x[k] + h * velocity_[k];
  return StepStatus::ok;
}

template <class T>
void SizedGauss<T>::move_action(T& s, const T* p, const Few& time, const Few& alpha, const Few& scale, double h) {
  const std::size_t n = scene_->coordinates, stages = rule_.stages;
  Square matrix{};
  std::array<T, StageRule::most_stages> rate{};  // ṡ without the part of the stages in s
  for (std::size_t i = 0; i < stages; ++i) {
    for (std::size_t k = 0; k < n; ++k) {
      T pulled = p[k];
      for (std::size_t j = 0; j < stages; ++j)
        pulled = pulled - (h * rule_.of_places[i][j] * scale[j]) * slope_[j * n + k];
      momentum_[k] = pulled / scale[i];
    }
    scene_->velocity(momentum_.data(), velocity_.data());
    T twice(0), potential(0);
    for (std::size_t k = 0; k < n; ++k) twice = twice + momentum_[k] * velocity_[k];
    scene_->potential.evaluate(&place_[i * n], time[i], &potential);
    rate[i] = 0.5 * twice - potential - alpha[i] * s;
    for (std::size_t j = 0; j < stages; ++j)
      matrix[i * stages + j] = (i == j ? 1 : 0) + h * rule_.of_places[i][j] * alpha[i];
  }
  // ṡ_i + α_i h Σ_j a_ij ṡ_j = K_i − V_i − α_i s₀
  detail::invert(stages, matrix.data());
  for (std::size_t i = 0; i < stages; ++i)
    for (std::size_t j = 0; j < stages; ++j) s = s + (h * rule_.weight[i] * matrix[i * stages + j]) * rate[j];
}

template class SizedGauss<double>;
template class SizedGauss<Slope>;

}  // namespace least
