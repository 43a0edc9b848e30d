// contact_gauss for a Hamiltonian H(q, p, s, t) of which no more is known: the same collocation of the same lift,
//   q′ = H_p,  P_q′ = P_s H_q,  s′ = p·H_p − H,  P_s′ = P_s H_s,  p = −P_q/P_s
// from P_s = 1, P_q = −p, with all of it unknown at every stage: a simplified Newton iteration.
#pragma once

#include <memory>

#include "core/schemes/contact_gauss.hpp"
#include "core/simplified_newton.hpp"

namespace least {

template <GeneralHamiltonian P, class X>
class HamiltonianGaussStepper {
 public:
  using T = typename X::Number;
  using S = typename X::Time;

  HamiltonianGaussStepper(const P& problem, int stages)
      : problem_(problem),
        stages_(std::size_t(stages)),
        n_(problem.coordinates()),
        width_(2 * n_ + 2),
        newton_(std::make_shared<SimplifiedNewton<T>>(stages_ * width_)) {}

  StepStatus step(X& x, const S& h) noexcept {
    return stages_ == 1 ? take<1>(x, h) : stages_ == 2 ? take<2>(x, h) : take<3>(x, h);
  }
  const Work& work() const { return work_; }

 private:
  static constexpr std::size_t widest = 2 * P::dof + 2, most = 3 * widest;

  /// (q, P_q, s, P_s)′ of n coordinates at a point y of the lift.
  template <class U, class V>
  void rates(const U* y, const V& t, U* rate) const {
    Vec<P::dof, U> q{}, p{};
    const U& scale = y[2 * n_ + 1];
    for (std::size_t i = 0; i < n_; ++i) {
      q[i] = y[i];
      p[i] = -(y[n_ + i] / scale);
    }
    const U& s = y[2 * n_];
    const auto slopes = problem_.slopes(q, p, s, phase(problem_, t));
    for (std::size_t i = 0; i < n_; ++i) {
      rate[i] = slopes.by_p[i];
      rate[n_ + i] = scale * slopes.by_q[i];
    }
    rate[2 * n_] = U(0);
    if (problem_.reads_action()) rate[2 * n_] = dot(p, slopes.by_p) - problem_.hamiltonian(q, p, s, phase(problem_, t));
    rate[2 * n_ + 1] = scale * slopes.by_s;
  }

  /// Computes the matrix 1 − h A ⊗ J, with the Jacobian J of the rates at the point y, and factors it. Returns false if
  /// AskedByThread::goes_on() does.
  template <int M>
  bool prepare(const std::array<double, widest>& y, double t, double h) {
    using D = Dual<double, 1>;
    const auto& rule = GaussRule<M, double>::get();
    std::array<D, widest> at, rate;
    std::array<double, widest> added{};  // what all components add to each one in a step
    const std::size_t all = M * width_;
    double* const entries = newton_->matrix.entries();
    for (std::size_t k = 0; k < width_; ++k) {
      for (std::size_t i = 0; i < width_; ++i) at[i] = D(y[i]);
      at[k].slope[0] = 1;
      rates(at.data(), t, rate.data());
      for (std::size_t i = 0; i < width_; ++i) added[i] += std::abs(h * rate[i].slope[0] * y[k]);
      for (std::size_t a = 0; a < M; ++a)
        for (std::size_t b = 0; b < M; ++b)
          for (std::size_t i = 0; i < width_; ++i)
            entries[(a * width_ + i) * all + b * width_ + k] =
                (a == b && i == k ? 1 : 0) - h * rule.a[a][b] * rate[i].slope[0];
    }
    weigh(y, added);
    work_.forces += std::int64_t(width_);
    return newton_->matrix.factor();
  }

  /// Sets the weights of the components. Positions, momenta, the action and P_s have units of their own: each kind is
  /// measured relative to its size at the point y plus what a step adds to it.
  void weigh(const std::array<double, widest>& y, const std::array<double, widest>& added) {
    const std::array<std::size_t, 5> kinds{0, n_, 2 * n_, 2 * n_ + 1, width_};
    for (std::size_t kind = 0; kind + 1 < kinds.size(); ++kind) {
      double size = 0;
      for (std::size_t i = kinds[kind]; i < kinds[kind + 1]; ++i) size += std::abs(y[i]) + added[i];
      for (std::size_t i = kinds[kind]; i < kinds[kind + 1]; ++i) weights_[i] = size > 0 ? 1 / size : 1;
    }
  }

  template <int M>
  StepStatus take(X& x, const S& h) noexcept {
    using least::abs;
    using least::any;
    const auto& rule = GaussRule<M, S>::get();
    std::array<T, widest> start, at, end;
    std::array<double, widest> middle{};
    for (std::size_t i = 0; i < n_; ++i) {
      start[i] = x.q[i];
      start[n_ + i] = -x.p[i];
    }
    start[2 * n_] = x.action.s;
    start[2 * n_ + 1] = T(1);
    for (std::size_t i = 0; i < width_; ++i) middle[i] = plain_number(start[i]);
    for (auto& z : z_) z = T(0);
    const auto look = [&](const T* z) {
      for (std::size_t j = 0; j < M; ++j) {
        for (std::size_t i = 0; i < width_; ++i) at[i] = start[i] + z[j * width_ + i];
        rates(at.data(), x.t + rule.node[j] * h, rates_.data() + j * width_);
      }
    };
    const auto residual = [&](const T* z, T* wrong) {
      look(z);
      work_.forces += M;
      for (std::size_t a = 0; a < M; ++a)
        for (std::size_t i = 0; i < width_; ++i) {
          T sum = z[a * width_ + i];
          for (std::size_t b = 0; b < M; ++b) sum = sum - (h * rule.a[a][b]) * rates_[b * width_ + i];
          wrong[a * width_ + i] = sum;
        }
    };
    bool first = true;  // the Jacobian is taken at the start of the step, later at the mean of its stages
    const auto prepare_at = [&](const T* z) {
      if (!first)
        for (std::size_t i = 0; i < width_; ++i) {
          middle[i] = plain_number(start[i]);
          for (std::size_t j = 0; j < M; ++j) middle[i] += plain_number(z[j * width_ + i]) / M;
        }
      const double time = plain_number(first ? T(x.t) : T(x.t + h / 2));
      first = false;
      return prepare<M>(middle, time, plain_number(T(h)));
    };
    constexpr double size = 4;  // of four kinds, each weighed to 1
    const auto weight = [&](std::size_t a) { return weights_[a % width_]; };
    if (const StepStatus status = newton_->solve(z_.data(), size, weight, residual, prepare_at, work_);
        status != StepStatus::ok)
      return status;
    look(z_.data());
    for (std::size_t i = 0; i < width_; ++i) {
      end[i] = start[i];
      for (std::size_t j = 0; j < M; ++j) end[i] = end[i] + (h * rule.weight[j]) * rates_[j * width_ + i];
    }
    const T& lifted = end[2 * n_ + 1];
    if (any(!(abs(lifted) > T(least_denominator)))) return StepStatus::singular;
    for (std::size_t i = 0; i < n_; ++i) {
      x.q[i] = end[i];
      x.p[i] = -(end[n_ + i] / lifted);
    }
    x.action.s = end[2 * n_];
    return StepStatus::ok;
  }

  P problem_;
  std::size_t stages_, n_, width_;
  std::array<T, most> z_{}, rates_{};  ///< stages less the start, their rates
  std::array<double, widest> weights_{};
  std::shared_ptr<SimplifiedNewton<T>> newton_;  ///< shared by copies: it keeps nothing from one step to the next
  Work work_;
};

}  // namespace least
