#include "core/schemes/lifted_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/number/exponential.hpp"
#include "core/schemes/damping_pole.hpp"
#include "core/text/lift.hpp"

namespace least {
namespace {

/// Replaces b by x with A x = b; A is row-major and is overwritten. Not finite where A is singular.
template <class T>
void solve_in_place(std::size_t n, T* a, T* b) {
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    double most = std::abs(plain_number(a[k * n + k]));
    for (std::size_t i = k + 1; i < n; ++i)
      if (const double size = std::abs(plain_number(a[i * n + k])); size > most) {
        most = size;
        pivot = i;
      }
    if (pivot != k) {
      std::swap_ranges(a + k * n, a + (k + 1) * n, a + pivot * n);
      std::swap(b[k], b[pivot]);
    }
    const T over = a[k * n + k] = T(1) / a[k * n + k];
    for (std::size_t i = k + 1; i < n; ++i) {
      const T f = a[i * n + k] * over;
      for (std::size_t j = k + 1; j < n; ++j) a[i * n + j] = a[i * n + j] - f * a[k * n + j];
      b[i] = b[i] - f * b[k];
    }
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t j = i + 1; j < n; ++j) b[i] = b[i] - a[i * n + j] * b[j];
    b[i] = b[i] * a[i * n + i];
  }
}

/// φ₁(hB).
std::vector<double> phi_one(std::size_t n, const std::vector<double>& matrix, double h) {
  std::vector<double> z = matrix;
  for (double& entry : z) entry *= h;
  return phi(n, std::move(z)).one;
}
/// φ₁(hB) with its derivative, which is the upper right block of φ₁ of h [B B′; 0 B].
std::vector<Slope> phi_one(std::size_t n, const std::vector<Slope>& matrix, double h) {
  std::vector<double> block(4 * n * n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) {
      const Slope& entry = matrix[i * n + j];
      block[i * 2 * n + j] = block[(n + i) * 2 * n + n + j] = h * entry.value;
      block[i * 2 * n + n + j] = h * entry.slope[0];
    }
  const std::vector<double> found = phi(2 * n, std::move(block)).one;
  std::vector<Slope> made(n * n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) made[i * n + j] = {found[i * 2 * n + j], {found[i * 2 * n + n + j]}};
  return made;
}

int order_of(const Composition& composition) {
  return composition.weights().empty() ? compositions::orders[static_cast<std::size_t>(composition)]
                                       : compositions::order_of(composition.weights());
}

}  // namespace

template <class T>
class LiftedMap<T>::Steps {
 public:
  Steps(std::shared_ptr<const text::Lift> lift, const Composition& composition, LiftMethod method)
      : lift_(std::move(lift)),
        composition_(composition),
        weights_(&Weights<double>::of(composition_)),
        method_(method),
        rows_(static_cast<std::size_t>(order_of(composition_)) / 2) {
    if (method_ == LiftMethod::automatic) method_ = lift_->linear ? LiftMethod::exact : LiftMethod::midpoint;
    const std::size_t m = lift_->width, jets = m + m * m, point = lift_->variables;
    room_.resize(4 * point + 5 * jets);
  }

  void look(const T* q, double t, T* slope, Work& work);
  StepStatus step(const Place& x, double t, double h, Work& work);

 private:
  /// The exact motion over h: e^{hB} − 1 and e^{−hB} − 1, both row-major, and the image of y = 0.
  struct Exact {
    double h;
    std::vector<T> onward, back, offset;
  };

  void kick(const Place& x, double h) const;
  void drift(const Place& x, double h) const;
  StepStatus lift(const Place& x, double t, double h, Work& work);
  // Each of these moves the point y by the lifted motion, and multiplies the row c by the inverse of its derivative.
  void exactly(const T* y, const T* c, T* onto, T* turned, double h);
  StepStatus by_midpoint(T* y, T* c, double t, double h, Work& work);
  StepStatus by_extrapolation(T* y, T* c, double t, double h, Work& work);
  const Exact& exact_for(double h);
  T* room(std::size_t i) { return room_.data() + i; }

  std::shared_ptr<const text::Lift> lift_;
  Composition composition_;  ///< keeps the weights
  const Weights<double>* weights_;
  LiftMethod method_;
  std::size_t rows_;  ///< rows of the extrapolation's table
  std::vector<Exact> known_;
  std::vector<T> room_;
};

template <class T>
LiftedMap<T>::LiftedMap(std::shared_ptr<const text::Lift> lift, const Composition& composition, LiftMethod method) {
  if (lift) steps_ = std::make_shared<Steps>(std::move(lift), composition, method);
}
template <class T>
void LiftedMap<T>::begin(const T* q, double t, T* slope) {
  work_ = {};
  if (steps_) steps_->look(q, t, slope, work_);
}
template <class T>
StepStatus LiftedMap<T>::step(const Place& x, double t, double h) noexcept {
  return steps_ ? steps_->step(x, t, h, work_) : StepStatus::solver_failed;
}

template <class T>
void LiftedMap<T>::Steps::look(const T* q, double t, T* slope, Work& work) {
  if (!lift_->kicks) return;
  T* const y = room(0);
  std::copy_n(q, lift_->coordinates, y);
  y[lift_->variables - 1] = text::number_in<T>(lift_->parameter);
  lift_->kick.evaluate(y, t, slope);
  ++work.forces;
}

template <class T>
StepStatus LiftedMap<T>::Steps::step(const Place& x, double t, double h, Work& work) {
  double begin = t;
  for (std::size_t i = 0; i < static_cast<std::size_t>(weights_->stages); ++i) {
    const double part = weights_->gamma[i] * h, end = t + weights_->end[i] * h;
    kick(x, 0.5 * part);
    drift(x, 0.5 * part);
    if (const StepStatus status = this->lift(x, begin, part, work); status != StepStatus::ok) return status;
    drift(x, 0.5 * part);
    look(x.q, end, x.slope, work);
    kick(x, 0.5 * part);
    begin = end;
  }
  return StepStatus::ok;
}

template <class T>
void LiftedMap<T>::Steps::kick(const Place& x, double h) const {
  if (!lift_->kicks) return;
  const std::size_t n = lift_->coordinates;
  for (std::size_t i = 0; i < n; ++i) x.p[i] = x.p[i] - h * x.slope[i];
  if (x.s) *x.s = *x.s - h * x.slope[n];
}

template <class T>
void LiftedMap<T>::Steps::drift(const Place& x, double h) const {
  if (!lift_->kinetic) return;
  const std::size_t n = lift_->coordinates;
  const T* const inverse = lift_->inverse_mass.template in<T>().data();
  T twice(0);
  for (std::size_t i = 0; i < n; ++i) {
    T velocity(0);
    if (lift_->diagonal) {
      velocity = inverse[i] * x.p[i];
    } else {
      for (std::size_t j = 0; j < n; ++j) velocity = velocity + inverse[i * n + j] * x.p[j];
    }
    x.q[i] = x.q[i] + h * velocity;
    if (x.s) twice = twice + x.p[i] * velocity;
  }
  if (x.s) *x.s = *x.s + (0.5 * h) * twice;
}

/// A map Φ of points y = (q, s) takes the contact elements ds − p dq along: (−P, 1) ∝ (−p, 1) (DΦ)⁻¹. Where nothing
/// acts on s, y = q and P = p (DΦ)⁻¹.
template <class T>
StepStatus LiftedMap<T>::Steps::lift(const Place& x, double t, double h, Work& work) {
  const std::size_t n = lift_->coordinates, m = lift_->width, point = lift_->variables;
  T *y = room(0), *c = room(point);
  const bool acts = lift_->acts;
  if (method_ == LiftMethod::exact && !acts) {
    exactly(x.q, x.p, y, c, h);
    std::copy_n(y, n, x.q);
    std::copy_n(c, n, x.p);
    return StepStatus::ok;
  }
  for (std::size_t i = 0; i < n; ++i) {
    y[i] = x.q[i];
    c[i] = acts ? -x.p[i] : x.p[i];
  }
  y[n] = x.s ? *x.s : T(0);
  c[n] = T(1);
  y[point - 1] = text::number_in<T>(lift_->parameter);
  StepStatus status = StepStatus::ok;
  if (method_ == LiftMethod::exact) {
    exactly(y, c, room(2 * point), room(3 * point), h);
    y = room(2 * point);
    c = room(3 * point);
  } else {
    status = method_ == LiftMethod::midpoint ? by_midpoint(y, c, t, h, work) : by_extrapolation(y, c, t, h, work);
  }
  if (status != StepStatus::ok) return status;
  if (m > n && !(plain_number(c[n]) > least_denominator)) return StepStatus::singular;
  for (std::size_t i = 0; i < n; ++i) {
    x.q[i] = y[i];
    x.p[i] = acts ? -(c[i] / c[n]) : c[i];
  }
  if (x.s) *x.s = y[n];
  return StepStatus::ok;
}

template <class T>
void LiftedMap<T>::Steps::exactly(const T* y, const T* c, T* onto, T* turned, double h) {
  const std::size_t m = lift_->width;
  const Exact& flow = exact_for(h);
  for (std::size_t i = 0; i < m; ++i) {
    T sum = flow.offset[i], row(0);
    for (std::size_t j = 0; j < m; ++j) {
      sum = sum + flow.onward[i * m + j] * y[j];
      row = row + c[j] * flow.back[j * m + i];
    }
    onto[i] = y[i] + sum;
    turned[i] = c[i] + row;
  }
}

/// Computes the exact motion once for each length of a stage. Matrices are kept less the unit matrix, so that small
/// entries keep their digits: a rotation by the same rounded matrix would grow or shrink at every step.
template <class T>
auto LiftedMap<T>::Steps::exact_for(double h) -> const Exact& {
  constexpr std::size_t most_known = 64;
  auto& all = known_;
  if (const auto found = std::ranges::find(all, h, &Exact::h); found != all.end()) return *found;
  const std::size_t m = lift_->width;
  const std::vector<T>&matrix = lift_->matrix.template in<T>(), &offset = lift_->offset.template in<T>();
  const auto times_matrix = [&](const std::vector<T>& one, double time) {
    std::vector<T> made(m * m);
    for (std::size_t i = 0; i < m; ++i)
      for (std::size_t k = 0; k < m; ++k)
        for (std::size_t j = 0; j < m; ++j)
          made[i * m + j] = made[i * m + j] + (time * matrix[i * m + k]) * one[k * m + j];
    return made;
  };
  const std::vector<T> one = phi_one(m, matrix, h);
  Exact made{h, times_matrix(one, h), times_matrix(phi_one(m, matrix, -h), -h), std::vector<T>(m)};
  for (std::size_t i = 0; i < m; ++i)
    for (std::size_t j = 0; j < m; ++j) made.offset[i] = made.offset[i] + (h * one[i * m + j]) * offset[j];
  if (all.size() < most_known) all.emplace_back();
  return all.back() = std::move(made);
}

/// k = F(y + h k/2, t + h/2), Y = y + h k by Newton's method with the Jacobian at every look, J. DΦ is
/// (1 − hJ/2)⁻¹(1 + hJ/2), whose inverse takes one system more.
template <class T>
StepStatus LiftedMap<T>::Steps::by_midpoint(T* y, T* c, double t, double h, Work& work) {
  constexpr int most_rounds = 30;
  constexpr double small = 8 * std::numeric_limits<double>::epsilon();
  const std::size_t m = lift_->width, point = lift_->variables;
  const double half = 0.5 * h;
  T *const k = room(2 * point), *const middle = room(3 * point), *const jets = room(4 * point);
  T *const jacobian = jets + m, *const matrix = jets + m + m * m, *const change = matrix + m * m;
  lift_->rates.evaluate(y, t + half, k);
  ++work.forces;
  std::copy_n(y, point, middle);
  double before = std::numeric_limits<double>::infinity();
  for (int round = 0;; ++round) {
    if (round == most_rounds) return StepStatus::solver_failed;
    for (std::size_t i = 0; i < m; ++i) middle[i] = y[i] + half * k[i];
    lift_->jets.evaluate(middle, t + half, jets);
    ++work.forces;
    ++work.iterations;
    for (std::size_t i = 0; i < m; ++i) {
      change[i] = jets[i] - k[i];
      for (std::size_t j = 0; j < m; ++j) matrix[i * m + j] = T(i == j ? 1 : 0) - half * jacobian[i * m + j];
    }
    solve_in_place(m, matrix, change);
    // Each component is accurate to the rounding of itself and of the terms of its rate.
    double changed = 0;
    for (std::size_t i = 0; i < m; ++i) {
      k[i] = k[i] + change[i];
      double size = size_with_slopes(k[i]);
      for (std::size_t j = 0; j < m; ++j) size += size_with_slopes(jacobian[i * m + j] * middle[j]);
      size = size_with_slopes(y[i]) + std::abs(h) * size;
      const double moved = std::abs(h) * size_with_slopes(change[i]);
      if (!(moved < std::numeric_limits<double>::max())) return StepStatus::solver_failed;
      if (moved > 0) changed = std::max(changed, moved / size);
    }
    if (changed <= small || (changed >= 0.5 * before && changed <= 1e3 * small)) break;
    before = changed;
  }
  for (std::size_t i = 0; i < m; ++i) {
    T row = c[i];
    for (std::size_t j = 0; j < m; ++j) {
      row = row - (half * jacobian[j * m + i]) * c[j];
      matrix[i * m + j] = T(i == j ? 1 : 0) + half * jacobian[j * m + i];
    }
    change[i] = row;
  }
  for (std::size_t i = 0; i < m; ++i) y[i] = y[i] + h * k[i];
  std::copy_n(change, m, c);
  solve_in_place(m, matrix, c);
  return StepStatus::ok;
}

/// The explicit midpoint rule in 2, 4, 6, … parts, whose error is a series in their squared length: as many of its
/// terms are eliminated as the table has rows. The derivative goes through the same operations. Source: Hairer,
/// Nørsett, Wanner, Solving Ordinary Differential Equations I, 1993, II.9.
template <class T>
StepStatus LiftedMap<T>::Steps::by_extrapolation(T* y, T* c, double t, double h, Work& work) {
  const std::size_t m = lift_->width, point = lift_->variables, whole = m + m * m;
  T *const at = room(2 * point), *jets = room(4 * point), *left = jets + whole,
           *here = left + whole, *const all = here + whole, *const first = all + whole;
  std::copy_n(y, point, at);
  /// Moves `left` over a time of `length` by the rates in `jets`, at a point whose derivative is d; null: the unit
  /// matrix.
  const auto move = [&](double length, const T* d) {
    for (std::size_t i = 0; i < m; ++i) {
      left[i] = left[i] + length * jets[i];
      for (std::size_t j = 0; j < m; ++j) {
        T sum = jets[m + i * m + j];
        if (d) {
          sum = T(0);
          for (std::size_t k = 0; k < m; ++k) sum = sum + jets[m + i * m + k] * d[k * m + j];
        }
        left[m + i * m + j] = left[m + i * m + j] + length * sum;
      }
    }
  };
  const auto start_at = [&](T* z) {
    std::copy_n(y, m, z);
    for (std::size_t i = 0; i < m; ++i)
      for (std::size_t j = 0; j < m; ++j) z[m + i * m + j] = T(i == j ? 1 : 0);
  };
  lift_->jets.evaluate(y, t, first);
  ++work.forces;
  std::fill_n(all, whole, T(0));
  for (std::size_t row = 1; row <= rows_; ++row) {
    const std::size_t parts = 2 * row;
    const double length = h / static_cast<double>(parts);
    start_at(left);
    std::copy_n(first, whole, jets);
    move(length, nullptr);
    std::copy_n(left, whole, here);
    start_at(left);
    for (std::size_t part = 1; part < parts; ++part) {
      std::copy_n(here, m, at);
      lift_->jets.evaluate(at, t + static_cast<double>(part) * length, jets);
      ++work.forces;
      move(2 * length, here + m);
      std::swap(left, here);
    }
    double weight = 1;
    for (std::size_t other = 1; other <= rows_; ++other)
      if (other != row)
        weight *=
            static_cast<double>(row * row) / (static_cast<double>(row * row) - static_cast<double>(other * other));
    for (std::size_t i = 0; i < whole; ++i) all[i] = all[i] + weight * here[i];
  }
  std::copy_n(all, m, y);
  T* const turned = jets;  // the transposed derivative
  for (std::size_t i = 0; i < m; ++i)
    for (std::size_t j = 0; j < m; ++j) turned[i * m + j] = all[m + j * m + i];
  solve_in_place(m, turned, c);
  return StepStatus::ok;
}

template class LiftedMap<double>;
template class LiftedMap<Slope>;

}  // namespace least
