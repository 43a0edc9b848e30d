#include "core/catalogue/sized_herglotz.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/schemes/damping_pole.hpp"

namespace least {

template <class T>
template <class U>
SizedHerglotz<T>::Nodes<U>::Nodes(std::size_t n) : at(2 * n + 1), by_middle(n), by_start(n), by_shift(n) {
  node.fill(std::vector<U>(2 * n + 2));
}

template <class T>
SizedHerglotz<T>::SizedHerglotz(const text::SizedScene& scene, SizedPath path, const Composition& composition)
    : scene_(&scene),
      path_(path),
      composition_(composition),
      weights_(&Weights<double>::of(composition_)),
      n_(scene.coordinates),
      unknowns_(path == SizedPath::parabola ? 2 * n_ : n_ + (scene.acting ? 1 : 0)),
      looks_(path == SizedPath::straight ? 1
             : scene.acting              ? 4
                                         : 3),
      z_(unknowns_),
      start_(scene.components),
      rate_(scene.components),
      nodes_(n_),
      rows_(n_),
      trial_(unknowns_),
      wrong_(unknowns_),
      solver_(std::make_shared<Solver>(unknowns_)) {}

template <class T>
StepStatus SizedHerglotz<T>::step(T* x, double t, double h) noexcept {
  T energy(0);
  for (std::size_t i = 0; i < static_cast<std::size_t>(weights_->stages); ++i) {
    const double before = i == 0 ? 0 : weights_->end[i - 1];
    if (const auto status = stage(x, t + before * h, weights_->gamma[i] * h); status != StepStatus::ok) return status;
    energy = energy + weights_->gamma[i] * energy_;
  }
  energy_ = energy;
  return StepStatus::ok;
}

template <class T>
double SizedHerglotz<T>::step_energy(StateView from, double h) {
  std::vector<T> x(from.numbers, from.numbers + scene_->components);
  asks_energy_ = true;
  const StepStatus status = step(x.data(), from.t, h);
  asks_energy_ = false;
  return status == StepStatus::ok && std::isfinite(plain_number(energy_)) ? plain_number(energy_) : unknown;
}

template <class T>
StepStatus SizedHerglotz<T>::stage(T* x, double t, double h) {
  for (std::size_t i = 0; i < start_.size(); ++i) start_[i] = plain_number(x[i]);
  scene_->rate.evaluate(start_.data(), t, rate_.data());
  double size = 0;  // of velocities and σ: changes that do not change the place and s are round-off
  for (std::size_t i = 0; i < n_; ++i) {
    size += std::abs(start_[i]);
    z_[i] = T(path_ == SizedPath::straight ? rate_[i] : 0.5 * rate_[i]);
    if (path_ == SizedPath::parabola) z_[n_ + i] = T(rate_[i]);
  }
  const bool solves_for_action = unknowns_ > n_ && path_ == SizedPath::straight;
  if (solves_for_action) {
    size += std::abs(start_[2 * n_]);
    z_[n_] = T(rate_[2 * n_]);
  }
  size /= std::abs(h);
  const auto residual = [&](const T* z, T* wrong) {
    work_.forces += looks_;
    equations(x, t, h, z, nodes_, wrong);
  };
  const auto alike = [](std::size_t) { return 1.0; };
  guess_ = z_;
  bool at_guess = true;
  const auto make = [&](const T* z) {
    return std::exchange(at_guess, false) ? prepare_at_guess(t, h) : prepare(t, h, z);
  };
  StepStatus status = solver_->newton.solve(z_.data(), size, alike, residual, make, work_);
  if (status == StepStatus::solver_failed) {
    z_ = guess_;
    status = solve_closely(x, t, h);
  }
  if (status != StepStatus::ok) return status;
  work_.forces += looks_;
  return path_ == SizedPath::straight ? end_straight(x, t, h) : end_parabola(x, t, h);
}

template <class T>
bool SizedHerglotz<T>::prepare_at_guess(double t, double h) {
  if constexpr (std::is_same_v<T, double>) {
    return prepare(t, h, guess_.data());
  } else {
    Solver& s = *solver_;
    if (s.at_guess && t == s.t && h == s.h && start_ == s.start) return true;
    s.start = start_;
    s.t = t;
    s.h = h;
    return s.at_guess = prepare(t, h, guess_.data());
  }
}

template <class T>
bool SizedHerglotz<T>::prepare(double t, double h, const T* z) {
  solver_->at_guess = false;
  work_.forces += looks_ * static_cast<std::int64_t>(unknowns_);
  return fill_jacobian(z, trial_, wrong_, solver_->newton.matrix,
                       [&](const FewDirections* at, FewDirections* wrong) {
                         equations(start_.data(), t, h, at, rows_, wrong);
                       }) &&
         solver_->newton.matrix.factor();
}

/// solve_closely computes the matrix in each round, for steps so long that keeping it fails.
template <class T>
StepStatus SizedHerglotz<T>::solve_closely(const T* x, double t, double h) {
  constexpr int most_rounds = 50;
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  double size = 0, known = 0;
  for (const T& c : z_) known += 2 * std::abs(plain_number(c));
  for (std::size_t i = 0; i < n_; ++i) size += 8 * epsilon * std::abs(start_[i] / h);
  if (unknowns_ > n_ && path_ == SizedPath::straight) size += 8 * epsilon * std::abs(start_[2 * n_] / h);
  for (int round = 0, late = late_rounds<T>; round < most_rounds; ++round) {
    work_.forces += looks_;
    ++work_.iterations;
    if (!prepare(t, h, z_.data())) break;
    const T* const update =
        solver_->newton.update(z_.data(), [&](const T* z, T* wrong) { equations(x, t, h, z, nodes_, wrong); });
    double changed = 0;
    for (std::size_t i = 0; i < unknowns_; ++i) {
      changed += std::abs(plain_number(update[i]));
      z_[i] = z_[i] - update[i];
    }
    if (!(changed < std::numeric_limits<double>::max())) break;
    if (changed <= std::pow(epsilon, 0.75) * known + size && late-- == 0) return StepStatus::ok;
  }
  return StepStatus::solver_failed;
}

template <class T>
template <class A, class U>
void SizedHerglotz<T>::equations(const A* x, double t, double h, const U* z, Nodes<U>& nodes, U* wrong) const {
  const A* const p = x + n_;
  if (path_ == SizedPath::straight) {
    look_in_the_middle(x, t, h, z, nodes);
    const U *const l = nodes.node[0].data(), *const force = l + 1, *const pi = force + n_;
    const double half = h / 2;
    const U gain = 1 + half * l[2 * n_ + 1];
    for (std::size_t i = 0; i < n_; ++i) wrong[i] = pi[i] - half * force[i] - gain * p[i];
    if (unknowns_ > n_) wrong[n_] = z[n_] - l[0];
    return;
  }
  walk(x, t, h, z, nodes);
  for (std::size_t i = 0; i < n_; ++i) {
    wrong[i] = 0.25 * nodes.by_middle[i];
    wrong[n_ + i] = nodes.by_start[i] + nodes.factor * p[i];
  }
}

template <class T>
template <class A, class U>
void SizedHerglotz<T>::look_in_the_middle(const A* x, double t, double h, const U* z, Nodes<U>& nodes) const {
  const double half = h / 2;
  for (std::size_t i = 0; i < n_; ++i) {
    nodes.at[i] = x[i] + half * z[i];
    nodes.at[n_ + i] = z[i];
  }
  if (scene_->acting) nodes.at[2 * n_] = x[2 * n_] + half * z[n_];
  look(nodes, 0, t + half);
}

template <class T>
StepStatus SizedHerglotz<T>::end_straight(T* x, double t, double h) {
  look_in_the_middle(x, t, h, z_.data(), nodes_);
  const T *const l = nodes_.node[0].data(), *const force = l + 1;
  const double half = h / 2;
  const T gain = 1 + half * l[2 * n_ + 1], end = 1 - half * l[2 * n_ + 1];
  if (!(plain_number(end) > least_denominator)) return StepStatus::singular;
  if (asks_energy_) energy_ = energy_at(0, 1, 0);
  for (std::size_t i = 0; i < n_; ++i) {
    x[i] = x[i] + h * z_[i];
    x[n_ + i] = (gain * x[n_ + i] + h * force[i]) / end;
  }
  if (scene_->acting) x[2 * n_] = x[2 * n_] + h * z_[n_];
  return StepStatus::ok;
}

/// walk evaluates the stages of the Runge–Kutta scheme for s along the parabola with z = ((b − q₀)/h, (q₁ − q₀)/h);
/// each derivative of s₁ is carried through them: dk_{j+1} = own part + L_s · (part of h) · dk_j.
template <class T>
template <class A, class U>
void SizedHerglotz<T>::walk(const A* x, double t, double h, const U* z, Nodes<U>& nodes) const {
  const double half = h / 2;
  const auto stage = [&](std::size_t j, double time, const U& s, auto place, auto velocity) {
    for (std::size_t i = 0; i < n_; ++i) {
      nodes.at[i] = place(i);
      nodes.at[n_ + i] = velocity(i);
    }
    nodes.at[2 * n_] = s;
    look(nodes, j, t + time);
  };
  const auto middle = [&](std::size_t i) { return U(x[i] + h * z[i]); };
  const auto mean = [&](std::size_t i) { return z[n_ + i]; };
  const U s0 = scene_->acting ? U(x[2 * n_]) : U(0);
  const auto value = [&](std::size_t j) -> const U& { return nodes.node[j][0]; };
  stage(
      0, 0, s0, [&](std::size_t i) { return U(x[i]); }, [&](std::size_t i) { return U(4.0 * z[i] - z[n_ + i]); });
  stage(1, half, U(s0 + half * value(0)), middle, mean);
  if (scene_->acting) {
    stage(2, half, U(s0 + half * value(1)), middle, mean);
  } else {  // without s the middle is evaluated once
    nodes.node[2] = nodes.node[1];
  }
  stage(
      3, h, U(s0 + h * value(2)), [&](std::size_t i) { return U(x[i] + h * z[n_ + i]); },
      [&](std::size_t i) { return U(3.0 * z[n_ + i] - 4.0 * z[i]); });

  const auto force = [&](std::size_t j, std::size_t i) -> const U& { return nodes.node[j][1 + i]; };
  const auto pi = [&](std::size_t j, std::size_t i) -> const U& { return nodes.node[j][1 + n_ + i]; };
  const auto by_s = [&](std::size_t j) -> const U& { return nodes.node[j][1 + 2 * n_]; };
  const auto through = [&](const U& d1, const U& d2, const U& d3, const U& d4) {  // all are h times dk
    const U e2 = d2 + half * (by_s(1) * d1), e3 = d3 + half * (by_s(2) * e2), e4 = d4 + h * (by_s(3) * e3);
    return U((d1 + 2.0 * e2 + 2.0 * e3 + e4) / 6.0);
  };
  for (std::size_t i = 0; i < n_; ++i) {
    nodes.by_middle[i] = through(4.0 * pi(0, i), h * force(1, i), h * force(2, i), -4.0 * pi(3, i));
    nodes.by_start[i] = through(h * force(0, i) - 3.0 * pi(0, i), -pi(1, i), -pi(2, i), pi(3, i));
    nodes.by_shift[i] = through(h * force(0, i), h * force(1, i), h * force(2, i), h * force(3, i));
  }
  nodes.factor = 1.0 + through(h * by_s(0), h * by_s(1), h * by_s(2), h * by_s(3));
  nodes.gain = h * (value(0) + 2.0 * value(1) + 2.0 * value(2) + value(3)) / 6.0;
}

template <class T>
T SizedHerglotz<T>::energy_at(std::size_t j, double of_u, double of_w) const {
  const auto& node = nodes_.node[j];
  T sum = -node[0];
  for (std::size_t i = 0; i < n_; ++i)
    sum = sum + (of_w == 0 ? of_u * z_[i] : of_u * z_[i] + of_w * z_[n_ + i]) * node[1 + n_ + i];
  return sum;
}

template <class T>
StepStatus SizedHerglotz<T>::end_parabola(T* x, double t, double h) {
  walk(x, t, h, z_.data(), nodes_);
  if (!(std::abs(plain_number(nodes_.factor)) > least_denominator)) return StepStatus::singular;
  if (asks_energy_)
    energy_ = (energy_at(0, 4, -1) + 2.0 * energy_at(1, 0, 1) + 2.0 * energy_at(2, 0, 1) + energy_at(3, -4, 3)) / 6.0;
  for (std::size_t i = 0; i < n_; ++i) {
    x[i] = x[i] + h * z_[n_ + i];
    x[n_ + i] = nodes_.factor * x[n_ + i] + nodes_.by_shift[i];
  }
  if (scene_->acting) x[2 * n_] = x[2 * n_] + nodes_.gain;
  return StepStatus::ok;
}

template class SizedHerglotz<double>;
template class SizedHerglotz<Slope>;

}  // namespace least
