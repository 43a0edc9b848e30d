#include "core/catalogue/metric_jacobi_motion.hpp"

#include <algorithm>
#include <cmath>

namespace least {
namespace {

template <class T>
T product_of(const std::vector<T>& a, const std::vector<T>& b) {
  T sum = a[0] * b[0];
  for (std::size_t i = 1; i < a.size(); ++i) sum = sum + a[i] * b[i];
  return sum;
}

}  // namespace

template <class T>
MetricJacobiMotion<T>::Scratch::Scratch(const text::SizedScene& scene)
    : velocity(scene.coordinates),
      gradient(scene.coordinates),
      scale(scene.coordinates),
      looks(scene),
      rows(scene),
      in_time(scene.coordinates),
      along(scene.coordinates - 1),
      v(scene.coordinates),
      w(v),
      z(v),
      end(v),
      trial(v),
      slope(v),
      row_end(scene.coordinates),
      matrix(scene.coordinates * scene.coordinates) {}

template <class T>
MetricJacobiMotion<T>::MetricJacobiMotion(const text::SizedScene& scene, Quadrature quadrature, const T& level)
    : energy(level),
      scene_(&scene),
      n_(scene.coordinates),
      midpoint_(quadrature == Quadrature::midpoint),
      scratch_(std::make_shared<Scratch>(scene)) {}

template <class T>
void MetricJacobiMotion<T>::look(Site& x, Work& work) const {
  auto& known = scratch_->gradient;
  if (known.is_of(x.q))
    scene_->potential.evaluate(x.q.data(), 0.0, &x.potential);
  else
    x.potential = scene_->potential_with_gradient(x.q.data(), 0.0, known.values.data());
  ++work.forces;
}

template <class T>
void MetricJacobiMotion<T>::velocity(const Site& x, Numbers& v) const {
  auto& known = scratch_->velocity;
  if (!known.is_of(x.q, x.p)) raise(*scene_, x.q.data(), x.p.data(), known.values.data());
  std::ranges::copy(known.values, v.begin());
}

template <class T>
void MetricJacobiMotion<T>::gradient(const Numbers& q, Numbers& slope) const {
  auto& known = scratch_->gradient;
  if (!known.is_of(q)) scene_->gradient.evaluate(q.data(), 0.0, known.values.data());
  std::ranges::copy(known.values, slope.begin());
}

template <class T>
T MetricJacobiMotion<T>::kinetic(const Site& x) const {
  velocity(x, scratch_->w);
  return 0.5 * product_of(x.p, scratch_->w);
}

template <class T>
T MetricJacobiMotion<T>::scale(const Site& x, std::size_t i) const {
  using least::sqrt;
  auto& known = scratch_->scale;
  if (!known.is_of(x.q)) std::ranges::fill(known.values, T(0));
  if (!(known.values[i] > T(0))) {
    auto& look = scratch_->looks.here;
    look.look_lightly([&](std::size_t k) { return x.q[k]; }, [i](std::size_t k) { return T(k == i ? 1 : 0); });
    known.values[i] = sqrt(look.momentum(i));
  }
  return known.values[i];
}

template <class T>
T MetricJacobiMotion<T>::steepness(const Site& x) const {
  using least::sqrt;
  Scratch& s = *scratch_;
  gradient(x.q, s.slope);
  raise(*scene_, x.q.data(), s.slope.data(), s.w.data());
  return sqrt(product_of(s.slope, s.w));
}

template <class T>
template <class A, class U>
void MetricJacobiMotion<T>::time_equations(const A* q, const A* p, const A& h, const U* v, Looks<U>& looks,
                                           U* wrong) const {
  const A half = 0.5 * h;
  const auto velocity = [&](std::size_t i) { return v[i]; };
  if (midpoint_) {
    looks.here.look([&](std::size_t i) { return U(q[i] + half * v[i]); }, velocity);
    for (std::size_t i = 0; i < n_; ++i) wrong[i] = looks.here.momentum(i) - half * looks.here.force(i) - p[i];
    return;
  }
  looks.here.look([&](std::size_t i) { return U(q[i]); }, velocity);
  looks.there.look_lightly([&](std::size_t i) { return U(q[i] + h * v[i]); }, velocity);
  for (std::size_t i = 0; i < n_; ++i)
    wrong[i] = 0.5 * (looks.here.momentum(i) + looks.there.momentum(i)) - half * looks.here.force(i) - p[i];
}

/// in_time solves for v, with q₁ = q₀ + h v and p₁ = p₀ + (h/2)(F₀ + F₁), or p₀ + h F in the middle.
template <class T>
StepStatus MetricJacobiMotion<T>::in_time(Site& x, const T& h, Work& work) const {
  constexpr int most = 50;
  Scratch& s = *scratch_;
  velocity(x, s.v);
  plain_numbers(x.q, s.q);
  plain_numbers(x.p, s.p);
  const double length = plain_number(h);
  double scale = 0, grain = std::numeric_limits<double>::min();
  const auto see = [&] {
    for (const T& c : s.v) scale += std::abs(plain_number(c));
  };
  see();
  if (midpoint_) {  // the guess is v after half a kick
    time_equations(x.q.data(), x.p.data(), h, s.v.data(), s.looks, s.w.data());
    ++work.forces;
    for (std::size_t i = 0; i < n_; ++i) {
      s.w[i] = x.p[i] + 0.5 * h * s.looks.here.force(i);
      s.trial[i] = x.q[i] + 0.5 * h * s.v[i];
    }
    raise(*scene_, s.trial.data(), s.w.data(), s.v.data());
    see();
  }
  for (const double c : s.q) grain += 8 * epsilon * std::abs(c);
  grain /= std::abs(length);
  s.in_time.begin();
  for (int k = 0, late = late_rounds<T>;; ++k) {
    if (k == most) return StepStatus::solver_failed;
    ++work.forces;
    ++work.iterations;
    const bool known = s.in_time.look(
        s.v.data(), [&](const T* v, T* wrong) { time_equations(x.q.data(), x.p.data(), h, v, s.looks, wrong); },
        [&](const FewDirections* v, FewDirections* wrong) {
          time_equations(s.q.data(), s.p.data(), length, v, s.rows, wrong);
        });
    if (!known) return StepStatus::solver_failed;
    double change = 0;
    for (std::size_t i = 0; i < n_; ++i) {
      change += std::abs(plain_number(s.in_time.update[i]));
      s.v[i] = s.v[i] - s.in_time.update[i];
    }
    if (!(change < std::numeric_limits<double>::max())) return StepStatus::solver_failed;
    const double left = s.in_time.left(change);
    const bool small = change <= small_part(scale) + grain && left <= epsilon * scale + grain;
    if ((small || s.in_time.is_rounding(scale + grain / epsilon)) && late-- == 0) break;
  }
  time_equations(x.q.data(), x.p.data(), h, s.v.data(), s.looks, s.w.data());
  for (std::size_t i = 0; i < n_; ++i) {
    x.q[i] = x.q[i] + h * s.v[i];
    x.p[i] = x.p[i] + (midpoint_ ? h : T(0.5 * h)) * s.looks.here.force(i);
  }
  if (midpoint_) {
    ++work.forces;
    return StepStatus::ok;
  }
  look(x, work);
  s.looks.there.look([&](std::size_t i) { return x.q[i]; }, [&](std::size_t i) { return s.v[i]; });
  for (std::size_t i = 0; i < n_; ++i) x.p[i] = x.p[i] + 0.5 * h * s.looks.there.force(i);
  return StepStatus::ok;
}

template <class T>
template <class A, class U>
void MetricJacobiMotion<T>::try_end(const A* q, const A& level, double sign, const U* end, Looks<U>& looks) const {
  using least::sqrt;
  const auto way = [&](std::size_t i) { return U(end[i] - q[i]); };
  const auto left = [&](std::size_t i) { return midpoint_ ? U(0.5 * (q[i] + end[i])) : U(q[i]); };
  looks.here.look(left, way);
  U potential = looks.here.potential();
  if (!midpoint_) {
    looks.there.look_lightly([&](std::size_t i) { return end[i]; }, way);
    potential = 0.5 * (potential + looks.there.potential());
  }
  looks.length_squared = U(0);
  for (std::size_t i = 0; i < n_; ++i) {
    looks.lowered[i] = midpoint_ ? looks.here.momentum(i) : U(0.5 * (looks.here.momentum(i) + looks.there.momentum(i)));
    looks.length_squared = looks.length_squared + way(i) * looks.lowered[i];
  }
  looks.gap = level - potential;
  looks.h = sign * sqrt(looks.length_squared / (2 * looks.gap));
  if (midpoint_) looks.here.gradient(looks.slope.data());
}

template <class T>
StepStatus MetricJacobiMotion<T>::along(Site& x, std::size_t sigma, const T& delta, double sign, Work& work) const {
  using least::abs;
  if (n_ == 1) return along_line(x, delta, work);
  constexpr int most_halvings = 30;
  Scratch& s = *scratch_;
  const auto place = [sigma](std::size_t k) { return k < sigma ? k : k + 1; };  // coordinate of unknown k
  // The predictor: the time to cover δ, half a kick, the time again.
  velocity(x, s.v);
  T a = delta / s.v[sigma];
  auto& here = s.looks.here;
  here.look([&](std::size_t i) { return x.q[i]; }, [&](std::size_t i) { return s.v[i]; });
  for (std::size_t i = 0; i < n_; ++i) s.w[i] = x.p[i] + 0.5 * a * here.force(i);
  raise(*scene_, x.q.data(), s.w.data(), s.v.data());
  a = delta / s.v[sigma];
  if (!(sign * a > T(0))) return StepStatus::solver_failed;
  for (std::size_t i = 0; i < n_; ++i) s.end[i] = i == sigma ? T(x.q[i] + delta) : T(x.q[i] + a * s.v[i]);
  if (!midpoint_) {  // ∇V at the left end is known beforehand
    gradient(x.q, s.looks.slope);
    for (std::size_t i = 0; i < n_; ++i) s.rows.slope[i] = FewDirections(plain_number(s.looks.slope[i]));
  }
  const auto look_there = [&] {
    ++work.forces;
    try_end(x.q.data(), energy, sign, s.end.data(), s.looks);
    return s.looks.admissible();
  };
  if (!look_there()) return StepStatus::solver_failed;
  double way = 0, size = std::numeric_limits<double>::min();
  for (std::size_t i = 0; i < n_; ++i) {
    way += std::abs(plain_number(T((s.end[i] - x.q[i]) / s.looks.h * a)));
    size += std::abs(plain_number(x.q[i]));
  }
  const double tolerance = small_part(way) + epsilon * size, level = plain_number(energy);
  plain_numbers(x.q, s.q);
  plain_numbers(x.p, s.p);
  const auto wrong_of = [&](const auto* p, const auto& looks, auto* wrong) {
    for (std::size_t k = 0; k + 1 < n_; ++k) {
      const std::size_t i = place(k);
      wrong[k] = looks.lowered[i] / looks.h - 0.5 * looks.h * looks.force(looks.here, i) - p[i];
    }
  };
  for (std::size_t i = 0; i < n_; ++i) s.row_end[i] = FewDirections(plain_number(s.end[i]));
  s.along.begin();
  for (int k = 0, late = late_rounds<T>;; ++k) {
    if (k == most_iterations) return StepStatus::solver_failed;
    ++work.iterations;
    for (std::size_t i = 0; i + 1 < n_; ++i) s.z[i] = s.end[place(i)];
    auto& update = s.along.update;
    const auto in_numbers = [&](const T*, T* wrong) { wrong_of(x.p.data(), s.looks, wrong); };
    const bool known = s.along.look(s.z.data(), in_numbers, [&](const FewDirections* z, FewDirections* wrong) {
      for (std::size_t i = 0; i + 1 < n_; ++i) s.row_end[place(i)] = z[i];
      try_end(s.q.data(), level, sign, s.row_end.data(), s.rows);
      wrong_of(s.p.data(), s.rows, wrong);
    });
    if (!known) return StepStatus::solver_failed;
    bool small = true;  // NaN never is
    double changed = 0;
    for (std::size_t i = 0; i + 1 < n_; ++i) {
      const double change = std::abs(plain_number(update[i]));
      small = small && change <= tolerance;
      changed += change;
      s.end[place(i)] = s.z[i] - update[i];
    }
    small = s.along.left(changed) <= epsilon * (way + size) && small;
    if ((small || s.along.is_rounding(way + size)) && late-- == 0) break;
    for (int halvings = 0; !look_there(); ++halvings) {
      if (halvings == most_halvings) return StepStatus::solver_failed;
      for (std::size_t i = 0; i + 1 < n_; ++i) {
        update[i] = 0.5 * update[i];
        s.end[place(i)] = s.z[i] - update[i];
      }
    }
  }
  return arrive(x, a, sign, work);
}

/// arrive computes the momentum at the end that was found.
template <class T>
StepStatus MetricJacobiMotion<T>::arrive(Site& x, const T& a, double sign, Work& work) const {
  Scratch& s = *scratch_;
  auto& looks = s.looks;
  try_end(x.q.data(), energy, sign, s.end.data(), looks);
  const T h = looks.h, ratio = h / a;
  if (!looks.admissible() || !(ratio >= T(0.25) && ratio <= T(4))) return StepStatus::solver_failed;
  if (!midpoint_) {
    looks.there.look([&](std::size_t i) { return s.end[i]; }, [&](std::size_t i) { return T(s.end[i] - x.q[i]); });
    gradient(s.end, looks.slope);
  }
  for (std::size_t i = 0; i < n_; ++i) {
    x.p[i] = looks.lowered[i] / h + 0.5 * h * looks.force(midpoint_ ? looks.here : looks.there, i);
  }
  x.q = s.end;
  look(x, work);
  x.elapsed = x.elapsed + h;
  return StepStatus::ok;
}

/// along_line: in one dimension the way is known, and the time is ∫√(g/2(E₀ − V)) dq by the Gauss rule of three points.
template <class T>
StepStatus MetricJacobiMotion<T>::along_line(Site& x, const T& delta, Work& work) const {
  using least::sqrt;
  const double node = std::sqrt(15.0) / 10;
  const bool forward = x.p[0] > T(0);
  auto& look = scratch_->looks.here;
  bool admissible = true;
  const auto at = [&](const T& q) {  // E₀ − V, with the metric in `look`
    look.look_lightly([&](std::size_t) { return q; }, [](std::size_t) { return T(1); });
    ++work.forces;
    const T gap = energy - look.potential();
    admissible = admissible && gap > T(0);
    return gap;
  };
  const auto slowness = [&](double part) {  // dt/dq
    const T gap = at(x.q[0] + part * delta), root = sqrt(look.momentum(0) / (2 * gap));
    return forward ? root : T(-root);
  };
  const T left = slowness(0.5 - node), middle = slowness(0.5), right = slowness(0.5 + node);
  x.q[0] = x.q[0] + delta;
  const T gap = at(x.q[0]), speed = sqrt(2 * gap * look.momentum(0));
  if (!admissible) return StepStatus::solver_failed;
  x.p[0] = forward ? speed : T(-speed);
  x.potential = energy - gap;
  x.elapsed = x.elapsed + delta * (5 * left + 8 * middle + 5 * right) / 18;
  return StepStatus::ok;
}

/// energy_root replaces p_σ by the nearest root of H(q, p) = E₀.
template <class T>
bool MetricJacobiMotion<T>::energy_root(Site& x, std::size_t sigma) const {
  using least::sqrt;
  Scratch& s = *scratch_;
  velocity(x, s.v);
  for (std::size_t i = 0; i < n_; ++i) s.trial[i] = T(i == sigma ? 1 : 0);
  raise(*scene_, x.q.data(), s.trial.data(), s.w.data());
  const T v = s.v[sigma], w = s.w[sigma], excess = 0.5 * product_of(x.p, s.v) + x.potential - energy;
  const T discriminant = v * v - 2 * w * excess;
  if (!(discriminant >= T(0))) return false;
  const T root = sqrt(discriminant);
  x.p[sigma] = x.p[sigma] - 2 * excess / (v < T(0) ? T(v - root) : T(v + root));
  return true;
}

template <class T>
T MetricJacobiMotion<T>::kinetic_between(const Numbers& a, const Numbers& b, const Numbers& p) const {
  Scratch& s = *scratch_;
  const auto lower = [&](auto velocity, auto&& take) {
    for (const Numbers* q : {&a, &b}) {
      s.looks.here.look_lightly([&](std::size_t i) { return (*q)[i]; }, velocity);
      for (std::size_t i = 0; i < n_; ++i) take(i, T(0.5 * s.looks.here.momentum(i)));
    }
  };
  std::fill(s.matrix.begin(), s.matrix.end(), 0.0);
  for (std::size_t j = 0; j < n_; ++j)
    lower([j](std::size_t k) { return T(k == j ? 1 : 0); },
          [&](std::size_t i, const T& entry) { s.matrix[i * n_ + j] += plain_number(entry); });
  detail::invert(n_, s.matrix.data());
  Numbers w(n_), rest = p;
  for (int round = 0; round <= late_rounds<T>; ++round) {
    for (std::size_t i = 0; i < n_; ++i)
      for (std::size_t j = 0; j < n_; ++j) w[i] = w[i] + s.matrix[i * n_ + j] * rest[j];
    rest = p;
    lower([&](std::size_t k) { return w[k]; }, [&](std::size_t i, const T& entry) { rest[i] = rest[i] - entry; });
  }
  return 0.5 * product_of(p, w);
}

/// step_energy computes the momentum ḡv at the middle from those at the ends, since (q₁ − q₀)/h would lose digits.
template <class T>
T MetricJacobiMotion<T>::step_energy(const Site& x, const Site& y, const T& h) const {
  Numbers carried(n_), place(n_);
  for (std::size_t i = 0; i < n_; ++i) {
    carried[i] = 0.5 * (x.p[i] + y.p[i]);
    place[i] = 0.5 * (x.q[i] + y.q[i]);
  }
  if (midpoint_) {
    T potential;
    scene_->potential.evaluate(place.data(), 0.0, &potential);
    return kinetic_between(place, place, carried) + potential;
  }
  LagrangianLook<T>&left = scratch_->looks.here, &right = scratch_->looks.there;
  const auto rate = [&](std::size_t i) { return T((y.q[i] - x.q[i]) / h); };
  left.look([&](std::size_t i) { return x.q[i]; }, rate);
  right.look([&](std::size_t i) { return y.q[i]; }, rate);
  const T potential = 0.5 * (left.potential() + right.potential());
  for (std::size_t i = 0; i < n_; ++i) carried[i] = carried[i] - 0.25 * h * (right.force(i) - left.force(i));
  return kinetic_between(x.q, y.q, carried) + potential;
}

template class MetricJacobiMotion<double>;
template class MetricJacobiMotion<Slope>;

}  // namespace least
