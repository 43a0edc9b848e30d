#include "core/catalogue/sized_stages.hpp"

#include <algorithm>
#include <cmath>

#include "core/number/asked_by_thread.hpp"
#include "core/schemes/contact_gauss.hpp"

namespace least {
namespace {

template <int M>
StageRule gauss_rule() {
  const auto& known = GaussRule<M, double>::get();
  StageRule rule{M, {}, {}, {}, {}};
  for (std::size_t i = 0; i < M; ++i) {
    rule.weight[i] = known.weight[i];
    rule.node[i] = known.node[i];
    for (std::size_t j = 0; j < M; ++j) rule.of_places[i][j] = rule.of_momenta[i][j] = known.a[i][j];
  }
  return rule;
}

/// v₀ − 2v_m + v₁ = 0 for the velocities along a parabola.
constexpr std::array second_difference{1.0, -2.0, 1.0};
/// take_bend replaces Lobatto's three equations for a momentum, as residuals or as rows of the Jacobian, by the two
/// combinations that the principle implies, and by the linearity of velocities as the third, which follows from the
/// three if the metric is constant.
template <class T>
void take_bend(T& first, T& middle, T& last, const T& of_velocities) {
  const T start = first;
  first = (start + 2 * middle) / 3;
  last = last - start;
  middle = of_velocities;
}

}  // namespace

const StageRule StageRule::midpoint{1, {{{0.5}}}, {{{0.5}}}, {1}, {0.5}};
const StageRule StageRule::simpson{3,
                                   {{{0, 0, 0}, {5 / 24.0, 1 / 3.0, -1 / 24.0}, {1 / 6.0, 2 / 3.0, 1 / 6.0}}},
                                   {{{1 / 6.0, -1 / 6.0, 0}, {1 / 6.0, 1 / 3.0, 0}, {1 / 6.0, 5 / 6.0, 0}}},
                                   {1 / 6.0, 2 / 3.0, 1 / 6.0},
                                   {0, 0.5, 1},
                                   true};

StageRule StageRule::gauss(int stages) {
  return stages == 1 ? gauss_rule<1>() : stages == 2 ? gauss_rule<2>() : gauss_rule<3>();
}

template <class T>
SizedStages<T>::SizedStages(const text::SizedScene& scene, const StageRule& rule, const Composition& composition)
    : scene_(&scene),
      rule_(rule),
      composition_(composition),
      weights_(&Weights<double>::of(composition_)),
      width_(scene.acting ? 2 * scene.coordinates + 2 : scene.moving),
      row_(scene.acting ? width_ : scene.components),
      from_(row_),
      at_(row_),
      rates_(rule.stages * row_),
      z_(rule.stages * width_),
      middle_(row_),
      along_(row_),
      moved_(row_),
      newton_(std::make_shared<SimplifiedNewton<T>>(rule.stages * width_)),
      slow_(scene.equations.size() > 4096 || scene.equations.has_terms()) {
  if (!is_lifted()) return;
  for (std::vector<T>* of : {&lifted_.state, &lifted_.rate}) of->resize(scene.components);
  for (std::vector<FewDirections>* of : {&lifted_along_.state, &lifted_along_.rate}) of->resize(scene.components);
}

template <class T>
StepStatus SizedStages<T>::step(T* x, double t, double h) noexcept {
  double gone = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(weights_->stages); ++i) {
    const double gamma = weights_->gamma[i];
    if (const StepStatus status = stage(x, t + gone * h, gamma * h); status != StepStatus::ok) return status;
    gone += gamma;
  }
  return StepStatus::ok;
}

/// rates of the lift: with p = −P_q/P_s, the equations q̇ = H_p, ṗ = −H_q − p H_s and ṡ = p·H_p − H imply P_q′ = P_s
/// H_q and P_s′ = P_s H_s.
template <class T>
template <class U>
void SizedStages<T>::rates(const U* y, double t, U* rate, Lifted<U>& lifted) const {
  if (!is_lifted()) return scene_->rate.evaluate(y, t, rate);
  const std::size_t n = scene_->coordinates;
  std::vector<U>&x = lifted.state, &slope = lifted.rate;
  std::array<U, 2> h;  // H, H_s
  const U& scale = y[2 * n + 1];
  for (std::size_t i = 0; i < n; ++i) {
    x[i] = y[i];
    x[n + i] = -(y[n + i] / scale);
  }
  x[2 * n] = y[2 * n];
  scene_->rate.evaluate(x.data(), t, slope.data());
  scene_->hamiltonian.evaluate(x.data(), t, h.data());
  for (std::size_t i = 0; i < n; ++i) {
    rate[i] = slope[i];
    rate[n + i] = -(scale * (slope[n + i] + x[n + i] * h[1]));
  }
  rate[2 * n] = slope[2 * n];
  rate[2 * n + 1] = scale * h[1];
}

template <class T>
void SizedStages<T>::start(const T* x) {
  if (!is_lifted()) {
    std::copy_n(x, row_, from_.begin());
    return;
  }
  const std::size_t n = scene_->coordinates;
  for (std::size_t i = 0; i < n; ++i) {
    from_[i] = x[i];
    from_[n + i] = -x[n + i];
  }
  from_[2 * n] = x[2 * n];
  from_[2 * n + 1] = T(1);
}

template <class T>
bool SizedStages<T>::finish(T* x) const {
  if (!is_lifted()) {
    std::copy_n(from_.begin(), row_, x);
    return true;
  }
  const std::size_t n = scene_->coordinates;
  const T& scale = from_[2 * n + 1];
  if (!(std::abs(plain_number(scale)) > least_denominator)) return false;
  for (std::size_t i = 0; i < n; ++i) {
    x[i] = from_[i];
    x[n + i] = -(from_[n + i] / scale);
  }
  x[2 * n] = from_[2 * n];
  return true;
}

template <class T>
StepStatus SizedStages<T>::stage(T* x, double t, double h) {
  const std::size_t stages = rule_.stages, all = stages * width_;
  start(x);
  at_ = from_;
  std::fill(z_.begin(), z_.end(), T(0));
  const auto look = [&](const T* z) {
    for (std::size_t j = 0; j < stages; ++j) {
      for (std::size_t i = 0; i < width_; ++i) at_[i] = from_[i] + z[j * width_ + i];
      rates(at_.data(), t + rule_.node[j] * h, &rates_[j * row_], lifted_);
    }
    work_.forces += static_cast<std::int64_t>(stages);
  };
  const auto residual = [&](const T* z, T* wrong) {
    if (slow_ && !AskedByThread::goes_on()) {  // the solver fails on NaN
      std::fill_n(wrong, all, T(unknown));
      return;
    }
    look(z);
    for (std::size_t a = 0; a < stages; ++a)
      for (std::size_t i = 0; i < width_; ++i) {
        T sum = z[a * width_ + i];
        for (std::size_t b = 0; b < stages; ++b) sum = sum - (h * part(i)[a][b]) * rates_[b * row_ + i];
        wrong[a * width_ + i] = sum;
      }
    for (std::size_t i = 0; i < width_; ++i) {
      if (!is_bent(i)) continue;
      T bent(0);
      for (std::size_t b = 0; b < stages; ++b) bent = bent + second_difference[b] * rates_[b * row_ + i - width_ / 2];
      take_bend(wrong[i], wrong[width_ + i], wrong[2 * width_ + i], bent);
    }
  };
  bool first = true;  // the first matrix is that at the start of the step, later ones are at the mean of the stages
  const auto prepare_at = [&](const T* z) {
    for (std::size_t i = 0; i < row_; ++i) middle_[i] = plain_number(from_[i]);
    for (std::size_t i = 0; i < width_ && !first; ++i)
      for (std::size_t j = 0; j < stages; ++j)
        middle_[i] += plain_number(z[j * width_ + i]) / static_cast<double>(stages);
    const double time = first ? t : t + 0.5 * h;
    first = false;
    return prepare(middle_.data(), time, h);
  };
  const auto weight = [&](std::size_t a) { return weighs_[kind(a % width_)]; };
  const double size = is_lifted() ? 4 : 2;  // the number of kinds, each with the weighted size 1
  if (const auto status = newton_->solve(z_.data(), size, weight, residual, prepare_at, work_);
      status != StepStatus::ok)
    return status;
  look(z_.data());
  for (std::size_t j = 0; j < stages; ++j)
    for (std::size_t i = 0; i < row_; ++i) from_[i] = from_[i] + (h * rule_.weight[j]) * rates_[j * row_ + i];
  return finish(x) ? StepStatus::ok : StepStatus::singular;
}

template <class T>
bool SizedStages<T>::prepare(const double* y, double t, double h) {
  const bool asks = slow_ || newton_->matrix.is_large();
  std::array<double, 4> sizes{};
  for (std::size_t first = 0; first < width_; first += directions_at_once) {
    if (asks && !AskedByThread::goes_on()) return false;
    const std::size_t count = std::min(directions_at_once, width_ - first);
    for (std::size_t i = 0; i < row_; ++i) along_[i] = FewDirections(y[i]);
    for (std::size_t k = 0; k < count; ++k) along_[first + k].slope[k] = 1;
    if (is_lifted()) {
      rates(along_.data(), t, moved_.data(), lifted_along_);
    } else {
      scene_->motion().evaluate(along_.data(), t, moved_.data());
    }
    for (std::size_t i = 0; i < width_ && first == 0; ++i)
      sizes[kind(i)] += std::abs(y[i]) + std::abs(h * moved_[i].value);
    put_columns(first, count, h);
  }
  for (std::size_t kind = 0; kind < sizes.size(); ++kind) weighs_[kind] = sizes[kind] > 0 ? 1 / sizes[kind] : 1;
  work_.forces += static_cast<std::int64_t>(width_);
  return newton_->matrix.factor();
}

template <class T>
void SizedStages<T>::put_columns(std::size_t first, std::size_t count, double h) {
  const std::size_t stages = rule_.stages, all = stages * width_;
  double* const entries = newton_->matrix.entries();
  for (std::size_t i = 0; i < width_; ++i)
    for (std::size_t b = 0; b < stages; ++b)
      for (std::size_t k = 0; k < count; ++k) {
        const double slope = moved_[i].slope[k];
        const auto entry = [&](std::size_t a) -> double& {
          return entries[(a * width_ + i) * all + b * width_ + first + k];
        };
        for (std::size_t a = 0; a < stages; ++a)
          entry(a) = (a == b && i == first + k ? 1 : 0) - h * part(i)[a][b] * slope;
        if (is_bent(i)) take_bend(entry(0), entry(1), entry(2), second_difference[b] * moved_[i - width_ / 2].slope[k]);
      }
}

template class SizedStages<double>;
template class SizedStages<Slope>;

}  // namespace least
