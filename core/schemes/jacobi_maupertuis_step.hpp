// One step of the discrete Jacobi–Maupertuis principle: a coordinate q^σ is the parameter and moves by δ, the others
// follow from D₁A_d = −p, A_d = √(2(E₀ − V̄)) ℓ, and the time the step takes is h = ∂A_d/∂E₀ = ℓ/√(2(E₀ − V̄)). At that
// h the derivatives of A_d are those of the discrete Lagrangian and E_d = E₀: a variational step whose length is chosen
// by the energy, the momentum equation of q^σ left out. Order 2. At fixed q^σ it is symplectic in the other 2(n − 1)
// variables. It assumes E₀ − V > 0 and q̇^σ ≠ 0 along the step; where the solution is not the one near the motion
// (h outside [a/4, 4a], a from the predictor) the step fails.
// Source: Nair, Ober-Blöbaum, Marsden, The Jacobi–Maupertuis principle in variational integrators, 2009, eqs. 8–12.
#pragma once

#include <optional>

#include "core/schemes/discrete_lagrangian.hpp"
#include "core/schemes/jacobi_maupertuis_hybrid.hpp"

namespace least {

namespace detail {

/// Whether the change of an unknown is negligible; of a dual number, the changes of its derivatives have to be, too.
template <class T>
bool settled(const T& change, const T&, const T& tolerance) {
  using least::abs;
  return abs(change) <= tolerance;
}
template <class T, int K>
bool settled(const Dual<T, K>& change, const Dual<T, K>& x, const Dual<T, K>& tolerance) {
  using least::abs;
  bool all = settled(change.value, x.value, tolerance.value);
  for (std::size_t k = 0; k < K; ++k)
    all = all && settled(change.slope[k], x.slope[k], T(64 * Precision<T>::epsilon * (1 + abs(x.slope[k]))));
  return all;
}

}  // namespace detail

/// StepEnd is where a step begins or ends: a state, what is known of the mechanics there, and the time taken so far.
template <Conservative P, class T>
struct StepEnd {
  Vec<P::dof, T> q{}, p{};
  Slopes<P, T> here{};
  T elapsed{};
};

/// The equations of one step. `sign` is −1 for a step back in time, as compositions take them.
template <Conservative P, class T>
class JacobiMaupertuisStep {
 public:
  static constexpr std::size_t n = P::dof;
  static constexpr int most_iterations = 40;

  JacobiMaupertuisStep(const P& problem, Quadrature quadrature, const T& energy)
      : problem_(problem), quadrature_(quadrature), energy_(energy) {}

  /// Moves q^σ by δ, and everything else with it. A step that fails leaves x undefined.
  StepStatus step(StepEnd<P, T>& x, std::size_t sigma, const T& delta, double sign, Work& work) const {
    if constexpr (n == 1) {
      return quadrature_step(x, delta, work);
    } else {
      return solve(x, sigma, delta, sign, work);
    }
  }

  /// Replaces p_σ by the root of H(q, p) = E₀ nearest to it; false where there is none.
  bool energy_root(StepEnd<P, T>& x, std::size_t sigma) const {
    using least::sqrt;
    const auto v = x.here.raise(problem_, x.p);
    Vec<P::dof, T> unit{};
    unit[sigma] = T(1);
    const T w = x.here.raise(problem_, unit)[sigma], excess = 0.5 * dot(x.p, v) + x.here.potential - energy_;
    const T discriminant = v[sigma] * v[sigma] - 2 * w * excess;
    if (!(discriminant >= T(0))) return false;
    const T root = sqrt(discriminant);
    x.p[sigma] = x.p[sigma] - 2 * excess / (v[sigma] < T(0) ? v[sigma] - root : v[sigma] + root);
    return true;
  }

 private:
  /// The equations at a trial end.
  struct Trial {
    bool admissible = false;  ///< E₀ − V̄ > 0
    T length_squared{}, h{};
    Vec<P::dof, T> velocity{}, lowered{}, force{};  ///< Δ/h, ḡΔ, F₀
    Vec<P::dof, T> residual{};                      ///< −D₁A_d − p; its component σ is no equation
    LagrangianTerms<P, T> mean{};
  };
  /// `force` is taken at the left end, or at the middle: `mean` comes from the same points.
  Trial trial(const StepEnd<P, T>& x, const Vec<P::dof, T>& end, const LagrangianTerms<P, T>& mean,
              const Slopes<P, T>& at, double sign) const {
    using least::sqrt;
    Trial t;
    t.mean = mean;
    const T gap = energy_ - mean.potential;
    Vec<P::dof, T> way;
    for (std::size_t i = 0; i < n; ++i) way[i] = end[i] - x.q[i];
    t.lowered = mean.lower(problem_, way);
    t.length_squared = dot(way, t.lowered);
    t.admissible = gap > T(0);
    t.h = sign * sqrt(t.length_squared / (2 * gap));
    for (std::size_t i = 0; i < n; ++i) t.velocity[i] = way[i] / t.h;
    t.force = at.force(t.velocity);
    for (std::size_t i = 0; i < n; ++i) t.residual[i] = t.lowered[i] / t.h - 0.5 * t.h * t.force[i] - x.p[i];
    return t;
  }
  Trial trial(const StepEnd<P, T>& x, const Vec<P::dof, T>& end, double sign, Work& work) const {
    ++work.forces;
    if (quadrature_ == Quadrature::trapezoid)
      return trial(x, end, LagrangianTerms<P, T>(x.here, LagrangianTerms<P, T>(problem_, end)), x.here, sign);
    const Slopes<P, T> middle(problem_, middle_of(x.q, end));
    return trial(x, end, middle, middle, sign);
  }
  static Vec<P::dof, T> middle_of(const Vec<P::dof, T>& a, const Vec<P::dof, T>& b) {
    Vec<P::dof, T> m;
    for (std::size_t i = 0; i < n; ++i) m[i] = 0.5 * (a[i] + b[i]);
    return m;
  }

  StepStatus solve(StepEnd<P, T>& x, std::size_t sigma, const T& delta, double sign, Work& work) const {
    using least::abs;
    constexpr int unknowns = P::dof - 1;
    const auto place = [sigma](std::size_t k) { return k < sigma ? k : k + 1; };  // coordinate of the k-th unknown

    // The predictor: the time to cover δ, half a kick, the time again.
    auto v = x.here.raise(problem_, x.p);
    T a = delta / v[sigma];
    const auto kick = x.here.force(v);
    auto p = x.p;
    for (std::size_t i = 0; i < n; ++i) p[i] = p[i] + 0.5 * a * kick[i];
    v = x.here.raise(problem_, p);
    a = delta / v[sigma];
    if (!(sign * a > T(0))) return StepStatus::solver_failed;
    auto end = x.q;
    for (std::size_t i = 0; i < n; ++i) end[i] = i == sigma ? x.q[i] + delta : x.q[i] + a * v[i];
    Trial here = trial(x, end, sign, work);
    if (!here.admissible) return StepStatus::solver_failed;

    Mat<unknowns, T> jacobian;
    for (std::size_t i = 0; i < unknowns; ++i) {
      Vec<P::dof, T> unit{};
      unit[place(i)] = T(1);
      const auto column = here.mean.lower(problem_, unit);
      for (std::size_t j = 0; j < unknowns; ++j)
        jacobian[j][i] = (column[place(j)] - here.lowered[place(i)] * here.lowered[place(j)] / here.length_squared) / a;
    }
    T size(0);
    for (std::size_t i = 0; i < n; ++i) size = size + abs(here.velocity[i] * a);
    const T tolerance = std::pow(Precision<T>::epsilon, 0.75) * size + Precision<T>::epsilon * norm(x.q);

    for (int k = 0;; ++k) {
      if (k == most_iterations) return StepStatus::solver_failed;
      Vec<unknowns, T> right;
      for (std::size_t i = 0; i < unknowns; ++i) right[i] = here.residual[place(i)];
      auto update = LinearSolver<T>::solve(jacobian, right, coordinates_of(problem_) - 1);
      ++work.iterations;
      bool small = true, precise = true;  // false for NaN
      for (std::size_t i = 0; i < unknowns; ++i) {
        small = small && abs(update[i]) <= tolerance;
        precise = precise && detail::settled(update[i], end[place(i)], tolerance);
      }
      const auto from = end;
      for (std::size_t i = 0; i < unknowns; ++i) end[place(i)] = from[place(i)] - update[i];
      if (precise) break;
      Trial next = trial(x, end, sign, work);
      for (int halvings = 0; !next.admissible; ++halvings) {
        if (halvings == 30) return StepStatus::solver_failed;
        for (std::size_t i = 0; i < unknowns; ++i) {
          update[i] = 0.5 * update[i];
          end[place(i)] = from[place(i)] - update[i];
        }
        next = trial(x, end, sign, work);
      }
      if (!small) {  // Broyden: the Jacobian maps the last change to what it changed
        const T square = dot(update, update);
        for (std::size_t i = 0; i < unknowns; ++i) {
          T change = next.residual[place(i)] - here.residual[place(i)];
          for (std::size_t j = 0; j < unknowns; ++j) change = change + jacobian[i][j] * update[j];
          for (std::size_t j = 0; j < unknowns; ++j) jacobian[i][j] = jacobian[i][j] - change * update[j] / square;
        }
      }
      here = next;
    }
    return arrive(x, end, a, sign, work);
  }

  /// The momentum at the end that was found.
  StepStatus arrive(StepEnd<P, T>& x, const Vec<P::dof, T>& end, const T& a, double sign, Work& work) const {
    const Slopes<P, T> there(problem_, end);
    ++work.forces;
    Trial last;
    auto force = Vec<P::dof, T>{};
    if (quadrature_ == Quadrature::trapezoid) {
      last = trial(x, end, LagrangianTerms<P, T>(x.here, there), x.here, sign);
      force = there.force(last.velocity);
    } else {
      last = trial(x, end, sign, work);
      force = last.force;
    }
    const T ratio = last.h / a;
    if (!last.admissible || !(ratio >= T(0.25) && ratio <= T(4))) return StepStatus::solver_failed;
    x.q = end;
    for (std::size_t i = 0; i < n; ++i) x.p[i] = last.lowered[i] / last.h + 0.5 * last.h * force[i];
    x.here = there;
    x.elapsed = x.elapsed + last.h;
    return StepStatus::ok;
  }

  /// One degree of freedom: the way is known, the time is ∫√(g/2(E₀ − V)) dq by Gauss's rule of three points.
  StepStatus quadrature_step(StepEnd<P, T>& x, const T& delta, Work& work) const {
    using least::sqrt;
    const T node = sqrt(T(15)) / 10;
    const bool forward = x.p[0] > T(0);
    const auto slowness = [&](const T& part, bool& admissible) {  // dt/dq
      const LagrangianTerms<P, T> at(problem_, {x.q[0] + part * delta});
      ++work.forces;
      const T gap = energy_ - at.potential, root = sqrt(at.lower(problem_, Vec<P::dof, T>{T(1)})[0] / (2 * gap));
      admissible = admissible && gap > T(0);
      return forward ? root : -root;
    };
    bool admissible = true;
    const T left = slowness(0.5 - node, admissible), middle = slowness(T(0.5), admissible),
            right = slowness(0.5 + node, admissible);
    const Slopes<P, T> there(problem_, {x.q[0] + delta});
    ++work.forces;
    const T gap = energy_ - there.potential;
    if (!admissible || !(gap > T(0))) return StepStatus::solver_failed;
    const T speed = sqrt(2 * gap * there.lower(problem_, Vec<P::dof, T>{T(1)})[0]);
    x.q[0] = x.q[0] + delta;
    x.p[0] = forward ? speed : -speed;
    x.here = there;
    x.elapsed = x.elapsed + delta * (5 * left + 8 * middle + 5 * right) / 18;
    return StepStatus::ok;
  }

  static T norm(const Vec<P::dof, T>& q) {
    using least::abs;
    T sum(std::numeric_limits<double>::min());
    for (const T& c : q) sum = sum + abs(c);
    return sum;
  }

  const P& problem_;
  Quadrature quadrature_;
  T energy_;
};

/// E_d of a variational step of length h from x to y.
template <Conservative P, class T>
T step_energy(const P& problem, Quadrature quadrature, const StepEnd<P, T>& x, const StepEnd<P, T>& y, const T& h) {
  // The momentum ḡv at the middle from those at the ends, which loses no digits where (q₁ − q₀)/h would.
  Vec<P::dof, T> middle = x.q, rate, carried;
  for (std::size_t i = 0; i < rate.size(); ++i) {
    middle[i] = (y.q[i] + x.q[i]) * 0.5;
    rate[i] = (y.q[i] - x.q[i]) / h;
    carried[i] = (y.p[i] + x.p[i]) * 0.5;
  }
  if (quadrature == Quadrature::midpoint) {
    const LagrangianTerms<P, T> mean(problem, middle);
    return 0.5 * dot(carried, mean.raise(problem, carried)) + mean.potential;
  }
  const auto f0 = x.here.force(rate), f1 = y.here.force(rate);
  for (std::size_t i = 0; i < rate.size(); ++i) carried[i] = carried[i] - 0.25 * h * (f1[i] - f0[i]);
  const LagrangianTerms<P, T> mean(x.here, y.here);
  return 0.5 * dot(carried, mean.raise(problem, carried)) + mean.potential;
}

template <Conservative P, class T>
std::optional<T> paper_exit_step(const P& problem, Quadrature quadrature, const StepEnd<P, T>& x, const T& energy,
                                 const T& h0, Work& work) {
  return paper_exit_step(h0, [&](const T& h, bool& solved) {
    StepEnd<P, T> y = x;
    solved = solved && variational_step(problem, quadrature, y.q, y.p, y.here, h, work) == StepStatus::ok;
    return T(step_energy(problem, quadrature, x, y, h) - energy);
  });
}

}  // namespace least
