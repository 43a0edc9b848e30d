#include "core/catalogue/sized_implicit.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/number/asked_by_thread.hpp"
#include "core/number/linear.hpp"
#include "core/number/small_factors.hpp"
#include "core/schemes/damping_pole.hpp"

namespace least {
namespace {

/// pattern_of returns the sparsity pattern of M + β V″: that of V″ and of M; with several stages it is that of each
/// block.
SparsityPattern pattern_of(const text::SizedScene& scene, std::size_t stages) {
  SparsityPattern pattern = scene.curvature().pattern();
  const auto n = static_cast<std::uint32_t>(pattern.size());
  for (std::uint32_t i = 0; i < n; ++i) {
    if (!scene.has_full_mass()) {
      if (std::ranges::find(pattern[i], i) == pattern[i].end()) pattern[i].push_back(i);
      continue;
    }
    pattern[i].resize(n);
    for (std::uint32_t j = 0; j < n; ++j) pattern[i][j] = j;
  }
  if (stages == 1) return pattern;
  SparsityPattern all(stages * n);
  for (std::uint32_t a = 0; a < all.size(); ++a)
    for (std::uint32_t b = 0; b < stages; ++b)
      for (const std::uint32_t j : pattern[a % n]) all[a].push_back(b * n + j);
  return all;
}

}  // namespace

PlaceMatrix::PlaceMatrix(const text::SizedScene& scene, std::size_t stages)
    : scene_(&scene),
      stages_(stages),
      full_mass_(scene.has_full_mass()),
      mean_(stages > 1 ? scene.coordinates : 0),
      system_(pattern_of(scene, stages)),
      held_(HeldByThread::take_soon(system_.bytes())) {
  if (scene.has_full_mass()) {
    const std::size_t n = scene.coordinates;
    mass_.resize(n * n);
    for (std::size_t i = 0; i < n; ++i)
      for (const auto& [j, share] : scene.inverse_mass_matrix()[i]) mass_[i * n + j] = share;
    detail::invert(n, mass_.data());
  } else {
    for (const double w : scene.inverse_mass()) mass_.push_back(1 / w);
  }
}

/// Asks AskedByThread, which usually reads the clock, and takes as long as a few rows.
bool PlaceMatrix::goes_on() const {
  constexpr std::size_t few_rows = 16;
  return system_.size() <= few_rows || AskedByThread::goes_on();
}

bool PlaceMatrix::factor(const double* place, const double* beta, const double* t, Curvature at, Work& work,
                         double* slope) {
  const std::size_t n = scene_->coordinates;
  const auto& curvature = scene_->curvature();
  system_.clear();
  for (std::size_t a = 0; a < stages_; ++a) {
    const std::size_t first = a * n;
    if (full_mass_) {
      for (std::size_t i = 0; i < n * n; ++i) system_.add(first + i / n, first + i % n, mass_[i]);
    } else {
      for (std::size_t i = 0; i < n; ++i) system_.add(first + i, first + i, mass_[i]);
    }
  }
  const auto add = [&](std::size_t b, std::size_t row, std::size_t column, double value) {
    for (std::size_t a = 0; a < stages_; ++a) system_.add(a * n + row, b * n + column, beta[a * stages_ + b] * value);
  };
  const bool once = stages_ > 1 && at == Curvature::of_mean;
  if (once) {
    double time = 0;
    std::fill(mean_.begin(), mean_.end(), 0.0);
    for (std::size_t b = 0; b < stages_; ++b) {
      time += t[b] / static_cast<double>(stages_);
      for (std::size_t i = 0; i < n; ++i) mean_[i] += place[b * n + i] / static_cast<double>(stages_);
    }
    curvature.evaluate(scene_->gradient, mean_.data(), time, [&](std::size_t row, std::size_t column, double value) {
      for (std::size_t b = 0; b < stages_; ++b) add(b, row, column, value);
    });
  } else {
    for (std::size_t b = 0; b < stages_ && (b == 0 || goes_on()); ++b)
      curvature.evaluate(
          scene_->gradient, place + b * n, t[b],
          [&](std::size_t row, std::size_t column, double value) { add(b, row, column, value); }, slope);
  }
  const std::size_t evaluations = std::max<std::size_t>(curvature.evaluations(), slope ? 1 : 0);
  work.forces += static_cast<std::int64_t>(evaluations * (once ? 1 : stages_));
  return goes_on() && system_.factor();
}

PlaceSolver::PlaceSolver(const text::SizedScene& scene, std::size_t stages)
    : scene_(&scene),
      stages_(stages),
      matrix_(scene, stages),
      update_(stages * scene.coordinates),
      start_(update_.size()),
      place_(update_.size()),
      slope_(update_.size()) {}

/// iterate is a simplified Newton iteration: it keeps the matrix for a few rounds, and renews it if they contract
/// badly. It ends if an update is lost in the rounding of the place, or is close to that and the next one would be lost
/// in the rounding of the way from the start: a round is taken to contract at most four times worse than the one
/// before.
template <class Count, class Stages>
StepStatus PlaceSolver::iterate(Count n, Stages stages, const double* start, const double* beta, const double* t,
                                double* place, double* slope, Work& work) {
  constexpr int most_rounds = 60, patience = 5;
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  const std::size_t all = stages * n;
  double* const update = update_.data();
  std::copy_n(start, all, place);
  double before = std::numeric_limits<double>::infinity();
  for (int round = 0; round < most_rounds; ++round) {
    if (round == 0 &&
        !matrix_.factor(place, beta, t, PlaceMatrix::Curvature::of_mean, work, stages == 1 ? slope : nullptr))
      return StepStatus::solver_failed;
    if (round > 0 || stages > 1) {
      for (std::size_t b = 0; b < stages; ++b) scene_->gradient.evaluate(&place[b * n], t[b], &slope[b * n]);
      work.forces += static_cast<std::int64_t>(stages);
    }
    ++work.iterations;
    for (std::size_t a = 0; a < stages; ++a) {
      double* const wrong = &update[a * n];
      for (std::size_t i = 0; i < n; ++i) wrong[i] = beta[a * stages] * slope[i];
      for (std::size_t b = 1; b < stages; ++b)
        for (std::size_t i = 0; i < n; ++i) wrong[i] += beta[a * stages + b] * slope[b * n + i];
      for (std::size_t i = 0; i < n; ++i) wrong[i] += matrix_.times_mass(i, &place[a * n], start + a * n);
    }
    matrix_.solve(update);
    double changed = 0, size = std::numeric_limits<double>::min(), way = 0;
    for (std::size_t i = 0; i < all; ++i) {
      changed += std::abs(update[i]);
      size += std::abs(place[i]);
      way += std::abs(place[i] - start[i]);
    }
    if (!(changed < std::numeric_limits<double>::max())) return StepStatus::solver_failed;
    const double small = 2 * epsilon * size;
    // The slope belongs to the place, and the update is smaller than the accuracy of either.
    if (changed <= small || (changed >= 0.5 * before && changed <= 1e3 * small)) return StepStatus::ok;
    for (std::size_t i = 0; i < all; ++i) place[i] -= update[i];
    if (4 * changed * changed <= epsilon * way * before && changed <= 1e3 * small) {
      for (std::size_t b = 0; b < stages; ++b) scene_->gradient.evaluate(&place[b * n], t[b], &slope[b * n]);
      work.forces += static_cast<std::int64_t>(stages);
      return StepStatus::ok;
    }
    if (round % patience == patience - 1 && changed > 1e-2 * before &&
        !matrix_.factor(place, beta, t, PlaceMatrix::Curvature::of_mean, work))
      return StepStatus::solver_failed;
    before = changed;
  }
  return StepStatus::solver_failed;
}

StepStatus PlaceSolver::solve(const double* start, const double* beta, const double* t, std::vector<double>& place,
                              std::vector<double>& slope, Work& work) {
  if (stages_ > 1) return iterate(scene_->coordinates, stages_, start, beta, t, place.data(), slope.data(), work);
  return with_size(scene_->coordinates, [&](auto n) {
    return iterate(n, std::integral_constant<std::size_t, 1>{}, start, beta, t, place.data(), slope.data(), work);
  });
}

StepStatus PlaceSolver::solve(const Slope* start, const double* beta, const double* t, std::vector<Slope>& place,
                              std::vector<Slope>& slope, Work& work) {
  const std::size_t n = scene_->coordinates, all = update_.size();
  for (std::size_t i = 0; i < all; ++i) start_[i] = start[i].value;
  if (const auto status = solve(start_.data(), beta, t, place_, slope_, work); status != StepStatus::ok) return status;
  if (!matrix_.factor(place_.data(), beta, t, PlaceMatrix::Curvature::of_each, work)) return StepStatus::solver_failed;
  std::vector<double> change(n);
  for (std::size_t a = 0; a < stages_; ++a) {
    for (std::size_t i = 0; i < n; ++i) change[i] = start[a * n + i].slope[0];
    for (std::size_t i = 0; i < n; ++i) update_[a * n + i] = matrix_.times_mass(i, change.data());
  }
  matrix_.solve(update_.data());
  for (std::size_t i = 0; i < all; ++i) place[i] = Slope(place_[i], {update_[i]});
  for (std::size_t b = 0; b < stages_; ++b) scene_->gradient.evaluate(&place[b * n], t[b], &slope[b * n]);
  return StepStatus::ok;
}

template <class T>
SizedVariational<T>::SizedVariational(const text::SizedScene& scene, SizedPath path, const Composition& composition,
                                      double step, std::size_t components)
    : scene_(&scene),
      path_(path),
      acts_(scene.acting && components == scene.components),
      composition_(composition),
      weights_(&Weights<double>::of(composition_)),
      step_(step),
      slope_(scene.coordinates),
      momentum_(scene.coordinates),
      guess_(scene.coordinates),
      velocity_(scene.coordinates),
      middle_(scene.coordinates),
      bent_(scene.coordinates),
      solver_(std::make_shared<PlaceSolver>(scene)) {}

template <class T>
void SizedVariational<T>::begin(const T* x, double t) {
  work_ = {};
  if (path_ == SizedPath::straight) return;
  scene_->gradient.evaluate(x, t, slope_.data());
  ++work_.forces;
}

template <class T>
StepStatus SizedVariational<T>::step(T* x, double t, double h) noexcept {
  double gone = 0;
  T energy(0);
  for (std::size_t i = 0; i < static_cast<std::size_t>(weights_->stages); ++i) {
    const double part = weights_->gamma[i] * h, at = t + gone * h;
    const StepStatus status = path_ == SizedPath::straight ? midpoint(x, at, part) : simpson(x, at, part);
    if (status != StepStatus::ok) return status;
    energy = energy + weights_->gamma[i] * energy_;
    gone = weights_->end[i];
  }
  energy_ = energy;
  return StepStatus::ok;
}

template <class T>
double SizedVariational<T>::step_energy(StateView from, double h) {
  std::vector<T> x(from.numbers, from.numbers + 2 * slope_.size() + (acts_ ? 1 : 0));
  begin(x.data(), from.t);
  asks_energy_ = true;
  const StepStatus status = step(x.data(), from.t, h);
  asks_energy_ = false;
  return status == StepStatus::ok && std::isfinite(plain_number(energy_)) ? plain_number(energy_) : unknown;
}

/// midpoint: with f = (h/2) α at the middle: y = q₀ + (h/2) v, M v = (1 − f) p₀ − (h/2) ∇V(y).
template <class T>
StepStatus SizedVariational<T>::midpoint(T* x, double t, double h) {
  const std::size_t n = slope_.size();
  T* const p = x + n;
  const double half = h / 2, middle = t + half, loss = half * scene_->damping_at(middle), end = 1 + loss;
  if (!(end > least_denominator)) return StepStatus::singular;
  for (std::size_t i = 0; i < n; ++i) momentum_[i] = (1 - loss) * p[i];
  scene_->velocity(momentum_.data(), velocity_.data());
  for (std::size_t i = 0; i < n; ++i) guess_[i] = x[i] + half * velocity_[i];
  if (const auto status = solver_->solve(guess_.data(), half * half, middle, middle_, bent_, work_);
      status != StepStatus::ok)
    return status;
  for (std::size_t i = 0; i < n; ++i) {
    p[i] = (momentum_[i] - h * bent_[i]) / end;
    momentum_[i] = momentum_[i] - half * bent_[i];
  }
  scene_->velocity(momentum_.data(), velocity_.data());
  for (std::size_t i = 0; i < n; ++i) x[i] = x[i] + h * velocity_[i];
  if (!acts_ && !asks_energy_) return StepStatus::ok;
  const T twice = twice_kinetic(momentum_.data(), velocity_.data()), v = potential(middle_.data(), middle);
  energy_ = 0.5 * twice + v;
  if (!acts_) return StepStatus::ok;
  T& s = x[2 * n];
  const T before = s;
  s = ((1 - loss) * s + h * (0.5 * twice - v)) / end;
  energy_ = energy_ + scene_->damping_at(middle) * 0.5 * (before + s);
  return StepStatus::ok;
}

/// simpson: the stationary path of core/schemes/contact_galerkin_4.hpp, whose two equations are linear in u and w
/// except for ∇V(b). With the weights c_j of the stages of the Runge–Kutta scheme in s₁, which include their effect on
/// later stages, λ = 1 − Σ c_j h α_j and F = −∇V,
///   16 (c₁ + c₄) M u − (4c₁ + 12c₄) M w = −(c₂ + c₃) h F_b
///   (12c₁ + 4c₄) M u − (3c₁ − c₂ − c₃ + 3c₄) M w = λ p₀ + c₁ h F₀
template <class T>
StepStatus SizedVariational<T>::simpson(T* x, double t, double h) {
  const std::size_t n = slope_.size();
  T* const p = x + n;
  const double half = h / 2, first = scene_->damping_at(t), middle = scene_->damping_at(t + half),
               last = scene_->damping_at(t + h);
  const double a = half * middle, d = h * last;
  const double c1 = (1 - 2 * a + 2 * a * a - a * a * d) / 6, c2 = (2 - 2 * a + a * d) / 6, c3 = (2 - d) / 6,
               c4 = 1 / 6.0, c = c2 + c3;
  const double factor = 1 - h * (c1 * first + c * middle + c4 * last);
  if (!(std::abs(factor) > least_denominator)) return StepStatus::singular;
  const double of_u = 12 * c1 + 4 * c4, of_w = 3 * c1 - c + 3 * c4, ratio = (4 * c1 + 12 * c4) / of_w,
               whole = ratio * of_u - 16 * (c1 + c4);
  // u = (ratio M⁻¹(λp₀ + c₁hF₀) + c h M⁻¹F_b)/whole
  for (std::size_t i = 0; i < n; ++i) momentum_[i] = factor * p[i] - (c1 * h) * slope_[i];
  scene_->velocity(momentum_.data(), velocity_.data());
  for (std::size_t i = 0; i < n; ++i) guess_[i] = x[i] + h * (ratio / whole) * velocity_[i];
  if (const auto status = solver_->solve(guess_.data(), h * h * c / whole, t + half, middle_, bent_, work_);
      status != StepStatus::ok)
    return status;
  const bool asked = asks_energy_ || acts_;
  std::array<T, 3> twice{}, v{};
  if (asked) {
    v[0] = potential(x, t);
    v[1] = potential(middle_.data(), t + half);
  }
  // The momenta M u and M w replace momentum_ and guess_.
  for (std::size_t i = 0; i < n; ++i) {
    const T known = momentum_[i], u = (ratio * known - c * h * bent_[i]) / whole, w = (of_u * u - known) / of_w;
    momentum_[i] = w;
    guess_[i] = u;
    p[i] = factor * p[i] - h * (c1 * slope_[i] + c * bent_[i]);
  }
  scene_->velocity(momentum_.data(), velocity_.data());
  for (std::size_t i = 0; i < n; ++i) x[i] = x[i] + h * velocity_[i];
  scene_->gradient.evaluate(x, t + h, slope_.data());
  ++work_.forces;
  for (std::size_t i = 0; i < n; ++i) p[i] = p[i] - (h * c4) * slope_[i];
  if (!asked) return StepStatus::ok;

  v[2] = potential(x, t + h);
  std::vector<T>& at = middle_;  // its values are no longer needed
  for (std::size_t k = 0; k < 3; ++k) {
    constexpr double u_part[] = {4, 0, -4}, w_part[] = {-1, 1, 3};
    for (std::size_t i = 0; i < n; ++i) at[i] = u_part[k] * guess_[i] + w_part[k] * momentum_[i];
    scene_->velocity(at.data(), velocity_.data());
    twice[k] = twice_kinetic(at.data(), velocity_.data());
  }
  if (!acts_) {
    energy_ = ((0.5 * twice[0] + v[0]) + 4 * (0.5 * twice[1] + v[1]) + (0.5 * twice[2] + v[2])) / 6;
    return StepStatus::ok;
  }
  T& s = x[2 * n];
  const auto lagrangian = [&](std::size_t node, double loss, const T& action) {
    return 0.5 * twice[node] - v[node] - loss * action;
  };
  const T k1 = lagrangian(0, first, s), k2 = lagrangian(1, middle, s + half * k1),
          k3 = lagrangian(1, middle, s + half * k2), k4 = lagrangian(2, last, s + h * k3);
  energy_ = ((twice[0] - k1) + 2 * (twice[1] - k2) + 2 * (twice[1] - k3) + (twice[2] - k4)) / 6;
  s = s + h * (k1 + 2 * k2 + 2 * k3 + k4) / 6;
  return StepStatus::ok;
}

template <class T>
T SizedVariational<T>::potential(const T* q, double t) const {
  T v(0);
  scene_->potential.evaluate(q, t, &v);
  return v;
}

template <class T>
T SizedVariational<T>::twice_kinetic(const T* p, const T* v) const {
  T sum(0);
  for (std::size_t i = 0; i < slope_.size(); ++i) sum = sum + p[i] * v[i];
  return sum;
}

template <class T>
std::string SizedVariational<T>::unsupported_reason() const {
  if (!scene_->acting || path_ == SizedPath::parabola || !scene_->constant_damping) return {};
  return unsupported_by_pole(composition_, scene_->damping_at(0) * step_);
}
template <class T>
double SizedVariational<T>::flips_from() const {
  const bool turns = scene_->acting && path_ == SizedPath::straight;
  return turns ? least::flips_from(composition_) : std::numeric_limits<double>::infinity();
}
template <class T>
double SizedVariational<T>::stiff_from() const {
  const bool grows = scene_->acting && path_ == SizedPath::parabola;
  return grows ? 2 : std::numeric_limits<double>::infinity();
}

template class SizedVariational<double>;
template class SizedVariational<Slope>;

}  // namespace least
