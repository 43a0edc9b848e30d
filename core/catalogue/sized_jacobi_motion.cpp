#include "core/catalogue/sized_jacobi_motion.hpp"

#include <cmath>

#include "core/number/asked_by_thread.hpp"

namespace least {
namespace {

template <class T>
T dot_of(const std::vector<T>& a, const std::vector<T>& b) {
  T sum(0);
  for (std::size_t i = 0; i < a.size(); ++i) sum = sum + a[i] * b[i];
  return sum;
}

/// is_near returns whether the time h of a step is comparable with the time a of the motion itself.
template <class T>
bool is_near(const T& h, const T& a) {
  const T ratio = h / a;
  return ratio >= T(0.25) && ratio <= T(4);
}

}  // namespace

template <class T>
SizedJacobiMotion<T>::SizedJacobiMotion(const text::SizedScene& scene, Quadrature quadrature, const T& level)
    : energy(level),
      scene_(&scene),
      quadrature_(quadrature),
      slow_(scene.equations.size() > 4096 || scene.equations.has_terms()),
      scale_(scene.coordinates),
      matrix_(std::make_shared<PlaceMatrix>(scene)),
      scratch_(std::make_shared<Scratch>()) {
  const std::size_t n = scene.coordinates;
  Scratch& s = *scratch_;
  for (Numbers* of : {&s.v, &s.w, &s.free, &s.bent, &s.end, &s.slope, &s.wrong}) of->resize(n);
  for (std::vector<double>* of : {&s.place, &s.start, &s.border, &s.column, &s.part}) of->resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    s.column[i] = 1;
    scale_[i] = std::sqrt(matrix_->times_mass(i, s.column.data()));
    s.column[i] = 0;
  }
  if (quadrature == Quadrature::trapezoid)
    matrix_.reset();
  else
    solver_ = std::make_shared<PlaceSolver>(scene);
}

template <class T>
T SizedJacobiMotion<T>::look_at(const Numbers& q, Numbers& slope, Work& work) const {
  ++work.forces;
  return scene_->potential_with_gradient(q.data(), 0.0, slope.data());
}
template <class T>
void SizedJacobiMotion<T>::look(Site& x, Work& work) const {
  x.potential = look_at(x.q, x.slope, work);
}
template <class T>
T SizedJacobiMotion<T>::with_inverse_mass(const Numbers& a) const {
  scene_->velocity(a.data(), scratch_->w.data());
  return dot_of(a, scratch_->w);
}
template <class T>
T SizedJacobiMotion<T>::steepness(const Site& x) const {
  using least::sqrt;
  return sqrt(with_inverse_mass(x.slope));
}

template <class T>
StepStatus SizedJacobiMotion<T>::in_time(Site& x, const T& h, Work& work) const {
  if (quadrature_ == Quadrature::midpoint) return middle_step(x, h, work);
  const T half = 0.5 * h;
  for (std::size_t i = 0; i < size(); ++i) x.p[i] = x.p[i] - half * x.slope[i];
  velocity(x, scratch_->v);
  for (std::size_t i = 0; i < size(); ++i) x.q[i] = x.q[i] + h * scratch_->v[i];
  look(x, work);
  for (std::size_t i = 0; i < size(); ++i) x.p[i] = x.p[i] - half * x.slope[i];
  return StepStatus::ok;
}

/// middle_step solves M (y − q₀) − (h/2) p₀ + (h²/4) ∇V(y) = 0; derivatives by one more round of Newton's method.
template <class T>
StepStatus SizedJacobiMotion<T>::middle_step(Site& x, const T& h, Work& work) const {
  Scratch& s = *scratch_;
  const std::size_t n = size();
  const double half = 0.5 * plain_number(h), beta = half * half, none = 0;
  velocity(x, s.v);
  for (std::size_t i = 0; i < n; ++i) s.start[i] = plain_number(x.q[i]) + half * plain_number(s.v[i]);
  if (const auto status = solver_->solve(s.start.data(), beta, none, s.place, s.part, work); status != StepStatus::ok)
    return status;
  for (std::size_t i = 0; i < n; ++i) s.end[i] = T(s.place[i]);
  if constexpr (late_rounds > 0) {
    if (!matrix_->factor(s.place.data(), &beta, &none, PlaceMatrix::Curvature::of_each, work))
      return StepStatus::solver_failed;
    look_at(s.end, s.slope, work);
    for (std::size_t i = 0; i < n; ++i) s.start[i] = x.q[i].slope[0];
    for (std::size_t i = 0; i < n; ++i)
      s.border[i] =
          matrix_->times_mass(i, s.start.data()) + (0.5 * h * x.p[i] - 0.25 * h * h * T(s.slope[i].value)).slope[0];
    matrix_->solve(s.border.data());
    for (std::size_t i = 0; i < n; ++i) s.end[i].slope[0] = s.border[i];
  }
  look_at(s.end, s.slope, work);
  for (std::size_t i = 0; i < n; ++i) s.free[i] = x.p[i] - 0.5 * h * s.slope[i];
  scene_->velocity(s.free.data(), s.v.data());
  for (std::size_t i = 0; i < n; ++i) {
    x.q[i] = x.q[i] + h * s.v[i];
    x.p[i] = x.p[i] - h * s.slope[i];
  }
  return StepStatus::ok;
}

template <class T>
StepStatus SizedJacobiMotion<T>::along(Site& x, std::size_t sigma, const T& delta, double sign, Work& work) const {
  if (size() == 1) return along_line(x, delta, work);
  if (slow_ && !AskedByThread::goes_on()) return StepStatus::solver_failed;
  // The predictor: the time to cover δ, half a kick, the time again.
  Scratch& s = *scratch_;
  velocity(x, s.v);
  T a = delta / s.v[sigma];
  for (std::size_t i = 0; i < size(); ++i) s.free[i] = x.p[i] - 0.5 * a * x.slope[i];
  scene_->velocity(s.free.data(), s.v.data());
  a = delta / s.v[sigma];
  if (!(sign * a > T(0))) return StepStatus::solver_failed;
  return quadrature_ == Quadrature::midpoint ? along_midpoint(x, sigma, delta, a, work)
                                             : along_trapezoid(x, sigma, delta, a, work);
}

template <class T>
double SizedJacobiMotion<T>::grain_of(const Numbers& q, const T& a) const {
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  const Scratch& s = *scratch_;
  double way = std::numeric_limits<double>::min(), size = way;
  for (std::size_t i = 0; i < q.size(); ++i) {
    way += std::abs(plain_number(s.v[i] * a));
    size += std::abs(plain_number(q[i]));
  }
  return std::abs(plain_number(a)) * (std::pow(epsilon, 0.75) + epsilon * size / way);
}

/// along_trapezoid: Δ = h u − (h²/2) M⁻¹∇V(q₀) + λ M⁻¹e_σ with u = M⁻¹p₀; Newton's method for h.
template <class T>
StepStatus SizedJacobiMotion<T>::along_trapezoid(Site& x, std::size_t sigma, const T& delta, const T& a,
                                                 Work& work) const {
  using least::abs;
  Scratch& s = *scratch_;
  const std::size_t n = size();
  const double grain = grain_of(x.q, a);
  scene_->velocity(x.p.data(), s.free.data());
  scene_->velocity(x.slope.data(), s.bent.data());
  s.part[sigma] = 1;
  scene_->velocity(s.part.data(), s.column.data());
  s.part[sigma] = 0;
  const double w = s.column[sigma];
  T h = a, lambda(0), potential(0), wrong(0), rate(0);
  const auto look_with = [&](const T& time) {  // the end of a step of this time, and its residual
    const T half_square = 0.5 * time * time;
    lambda = (delta - time * s.free[sigma] + half_square * s.bent[sigma]) / w;
    T square(0);
    for (std::size_t i = 0; i < n; ++i) {
      const T way = time * s.free[i] - half_square * s.bent[i] + lambda * s.column[i];
      s.end[i] = x.q[i] + way;
      square = square + way * (time * x.p[i] - half_square * x.slope[i] + (i == sigma ? lambda : T(0)));
    }
    potential = look_at(s.end, s.slope, work);
    const T gap = energy - 0.5 * (x.potential + potential);
    wrong = square - 2 * time * time * gap;
    const T of_lambda = (time * s.bent[sigma] - s.free[sigma]) / w;
    T turned(0), lifted(0);  // derivatives by time of half of ΔᵀMΔ, and of V at the end
    for (std::size_t i = 0; i < n; ++i) {
      const T v = s.free[i] - time * s.bent[i] + of_lambda * s.column[i];
      turned = turned + v * (time * x.p[i] - half_square * x.slope[i] + (i == sigma ? lambda : T(0)));
      lifted = lifted + v * s.slope[i];
    }
    rate = 2 * turned - 4 * time * gap + time * time * lifted;
    return gap > T(0);
  };
  if (!look_with(h)) return StepStatus::solver_failed;
  for (int k = 0, late = late_rounds;; ++k) {
    if (k == most_iterations) return StepStatus::solver_failed;
    ++work.iterations;
    T change = wrong / rate;
    const bool settled = abs(change) <= T(grain);
    for (int halvings = 0; !look_with(h - change); ++halvings) {
      if (halvings == most_halvings) return StepStatus::solver_failed;
      change = 0.5 * change;
    }
    h = h - change;
    if (settled && late-- == 0) break;
  }
  if (!is_near(h, a)) return StepStatus::solver_failed;
  for (std::size_t i = 0; i < n; ++i) {
    x.p[i] = x.p[i] - 0.5 * h * (x.slope[i] + s.slope[i]);
    x.q[i] = s.end[i];
    x.slope[i] = s.slope[i];
  }
  x.p[sigma] = x.p[sigma] + lambda / h;
  x.potential = potential;
  x.elapsed = x.elapsed + h;
  return StepStatus::ok;
}

template <class T>
void SizedJacobiMotion<T>::solve(Numbers& b) const {
  std::vector<double>& part = scratch_->part;
  for (std::size_t i = 0; i < b.size(); ++i) part[i] = plain_number(b[i]);
  matrix_->solve(part.data());
  if constexpr (std::is_same_v<T, double>) {
    std::copy(part.begin(), part.end(), b.begin());
  } else {
    for (std::size_t i = 0; i < b.size(); ++i) {
      const double value = part[i];
      part[i] = b[i].slope[0];
      b[i].value = value;
    }
    matrix_->solve(part.data());
    for (std::size_t i = 0; i < b.size(); ++i) b[i].slope[0] = part[i];
  }
  std::fill(part.begin(), part.end(), 0.0);
}

/// With y = q₀ + Δ/2: M (y − q₀) + (h²/4) ∇V(y) − (h/2) p₀ − (λ/2) e_σ = 0 and
/// 2 (y − q₀)ᵀM(y − q₀) − h² (E₀ − V(y)) = 0.
template <class T>
StepStatus SizedJacobiMotion<T>::along_midpoint(Site& x, std::size_t sigma, const T& delta, const T& a,
                                                Work& work) const {
  using least::abs;
  Scratch& s = *scratch_;
  const std::size_t n = size();
  const double grain = grain_of(x.q, a), none = 0;
  T h = a, lambda(0);
  Numbers &y = s.end, &lowered = s.bent;  // lowered: M (y − q₀)
  for (std::size_t i = 0; i < n; ++i) y[i] = x.q[i] + 0.5 * (i == sigma ? delta : a * s.v[i]);
  const auto lower = [&](auto part_of) {
    for (std::size_t i = 0; i < n; ++i) s.place[i] = part_of(y[i]) - part_of(x.q[i]);
    for (std::size_t i = 0; i < n; ++i) part_of(lowered[i]) = matrix_->times_mass(i, s.place.data());
  };
  const auto look_there = [&] {
    if constexpr (std::is_same_v<T, double>) {
      lower([](auto& number) -> auto& { return number; });
    } else {
      lower([](auto& number) -> auto& { return number.value; });
      lower([](auto& number) -> auto& { return number.slope[0]; });
    }
    return T(energy - look_at(y, s.slope, work));
  };
  T gap = look_there();
  if (!(gap > T(0))) return StepStatus::solver_failed;
  bool outworn = true;  // the matrix, which is kept for several rounds, but not for derivatives
  double before = std::numeric_limits<double>::infinity();
  for (int k = 0, late = late_rounds;; ++k) {
    if (k == most_iterations) return StepStatus::solver_failed;
    ++work.iterations;
    const double length = plain_number(h), beta = 0.25 * length * length;
    for (std::size_t i = 0; i < n; ++i) s.place[i] = plain_number(y[i]);
    if (outworn && !matrix_->factor(s.place.data(), &beta, &none, PlaceMatrix::Curvature::of_each, work))
      return StepStatus::solver_failed;
    T square(0);
    for (std::size_t i = 0; i < n; ++i) {
      square = square + (y[i] - x.q[i]) * lowered[i];
      s.wrong[i] = lowered[i] + 0.25 * h * h * s.slope[i] - 0.5 * h * x.p[i];
      s.border[i] = 0.5 * (length * plain_number(s.slope[i]) - plain_number(x.p[i]));
      s.column[i] = 0;
    }
    s.wrong[sigma] = s.wrong[sigma] - 0.5 * lambda;
    s.column[sigma] = 0.5;
    solve(s.wrong);
    matrix_->solve(s.border.data());
    matrix_->solve(s.column.data());
    // δy = A − B δh + C δλ, of which the component σ is 0.
    T excess = 2 * square - h * h * gap;
    double left = -2 * length * plain_number(gap);
    for (std::size_t i = 0; i < n; ++i) {
      const double share = s.column[i] / s.column[sigma];
      const double of_place = 4 * plain_number(lowered[i]) + length * length * plain_number(s.slope[i]);
      excess = excess - of_place * (s.wrong[i] - share * s.wrong[sigma]);
      left -= of_place * (s.border[i] - share * s.border[sigma]);
    }
    const T longer = excess / left;
    const T pushed = (s.border[sigma] * longer - s.wrong[sigma]) / s.column[sigma];
    double moved = 0, size = std::numeric_limits<double>::min();
    for (std::size_t i = 0; i < n; ++i) {
      s.wrong[i] = i == sigma ? T(0) : s.wrong[i] - s.border[i] * longer + s.column[i] * pushed;
      moved += std::abs(plain_number(s.wrong[i]));
      size += std::abs(plain_number(s.v[i] * a));
    }
    const double changed = moved / size + std::abs(plain_number(longer / a));
    outworn = late_rounds > 0 || changed > 1e-2 * before;
    before = changed;
    const bool settled = abs(longer) <= T(grain) && moved <= grain * size / std::abs(plain_number(a));
    T part(1);
    for (int halvings = 0;; ++halvings) {
      for (std::size_t i = 0; i < n; ++i) y[i] = y[i] - part * s.wrong[i];
      gap = look_there();
      if (gap > T(0)) break;
      if (halvings == most_halvings) return StepStatus::solver_failed;
      for (std::size_t i = 0; i < n; ++i) y[i] = y[i] + part * s.wrong[i];
      part = 0.5 * part;
    }
    h = h - part * longer;
    lambda = lambda - part * pushed;
    if (settled && late-- == 0) break;
  }
  if (!is_near(h, a)) return StepStatus::solver_failed;
  for (std::size_t i = 0; i < n; ++i) {
    x.q[i] = 2 * y[i] - x.q[i];
    x.p[i] = x.p[i] - h * s.slope[i];
  }
  x.p[sigma] = x.p[sigma] + lambda / h;
  look(x, work);
  x.elapsed = x.elapsed + h;
  return StepStatus::ok;
}

/// along_line: in one dimension the way is known, and the time is ∫√(M/2(E₀ − V)) dq by the Gauss rule of three points.
template <class T>
StepStatus SizedJacobiMotion<T>::along_line(Site& x, const T& delta, Work& work) const {
  using least::sqrt;
  const double node = std::sqrt(15.0) / 10, mass = scale_[0] * scale_[0];
  const bool forward = x.p[0] > T(0);
  bool admissible = true;
  const auto slowness = [&](double part) {  // dt/dq
    T potential(0);
    const T at = x.q[0] + part * delta;
    scene_->potential.evaluate(&at, 0.0, &potential);
    ++work.forces;
    const T gap = energy - potential, root = sqrt(mass / (2 * gap));
    admissible = admissible && gap > T(0);
    return forward ? root : -root;
  };
  const T left = slowness(0.5 - node), middle = slowness(0.5), right = slowness(0.5 + node);
  x.q[0] = x.q[0] + delta;
  look(x, work);
  if (!admissible || !(gap(x) > T(0))) return StepStatus::solver_failed;
  const T speed = sqrt(2 * gap(x) * mass);
  x.p[0] = forward ? speed : -speed;
  x.elapsed = x.elapsed + delta * (5 * left + 8 * middle + 5 * right) / 18;
  return StepStatus::ok;
}

/// energy_root replaces p_σ by the nearest root of H(q, p) = E₀.
template <class T>
bool SizedJacobiMotion<T>::energy_root(Site& x, std::size_t sigma) const {
  using least::sqrt;
  Scratch& s = *scratch_;
  velocity(x, s.v);
  s.part[sigma] = 1;
  scene_->velocity(s.part.data(), s.column.data());
  s.part[sigma] = 0;
  const double w = s.column[sigma];
  const T v = s.v[sigma], excess = 0.5 * dot_of(x.p, s.v) + x.potential - energy;
  const T discriminant = v * v - 2 * w * excess;
  if (!(discriminant >= T(0))) return false;
  const T root = sqrt(discriminant);
  x.p[sigma] = x.p[sigma] - 2 * excess / (v < T(0) ? v - root : v + root);
  return true;
}

template <class T>
T SizedJacobiMotion<T>::step_energy(const Site& x, const Site& y, const T& h) const {
  Scratch& s = *scratch_;
  const bool midpoint = quadrature_ == Quadrature::midpoint;
  T potential = 0.5 * (x.potential + y.potential);
  for (std::size_t i = 0; i < size(); ++i) {
    s.end[i] = 0.5 * (x.q[i] + y.q[i]);
    s.free[i] = 0.5 * (x.p[i] + y.p[i]);
    if (!midpoint) s.free[i] = s.free[i] + 0.25 * h * (y.slope[i] - x.slope[i]);
  }
  if (midpoint) scene_->potential.evaluate(s.end.data(), 0.0, &potential);
  return 0.5 * with_inverse_mass(s.free) + potential;
}

template class SizedJacobiMotion<double>;
template class SizedJacobiMotion<Slope>;

}  // namespace least
