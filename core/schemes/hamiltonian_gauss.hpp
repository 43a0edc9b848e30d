// contact_gauss for a Hamiltonian H(q, p, s, t) of which no more is known: the same collocation of the same lift,
//   q′ = H_p,  P_q′ = P_s H_q,  s′ = p·H_p − H,  P_s′ = P_s H_s,  p = −P_q/P_s
// from P_s = 1, P_q = −p, with all of it unknown at every stage. The stages are found by a simplified Newton iteration:
// its matrix is made of plain numbers, at the start of a step and anew where it contracts badly, so that derivatives
// that ride along converge with the stages. Source: Hairer & Wanner, Solving Ordinary Differential Equations II, 1996,
// IV.8.
#pragma once

#include "core/schemes/contact_gauss.hpp"

namespace least {

template <GeneralHamiltonian P, class X>
class HamiltonianGaussStepper {
 public:
  using T = typename X::Number;
  using S = typename X::Time;

  HamiltonianGaussStepper(const P& problem, int stages)
      : problem_(problem), stages_(std::size_t(stages)), n_(problem.coordinates()), width_(2 * n_ + 2) {}

  StepStatus step(X& x, const S& h) noexcept {
    return stages_ == 1 ? take<1>(x, h) : stages_ == 2 ? take<2>(x, h) : take<3>(x, h);
  }
  const Work& work() const { return work_; }

 private:
  static constexpr int most_iterations = 60, patience = 6;
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

  /// (1 − h A ⊗ J)⁻¹ with J at the point y.
  template <int M>
  void prepare(const std::array<double, widest>& y, double t, double h) {
    using D = Dual<double, 1>;
    const auto& rule = GaussRule<M, double>::get();
    std::array<D, widest> at, rate;
    const std::size_t all = M * width_;
    for (std::size_t k = 0; k < width_; ++k) {
      for (std::size_t i = 0; i < width_; ++i) at[i] = D(y[i]);
      at[k].slope[0] = 1;
      rates(at.data(), t, rate.data());
      for (std::size_t a = 0; a < M; ++a)
        for (std::size_t b = 0; b < M; ++b)
          for (std::size_t i = 0; i < width_; ++i)
            matrix_[(a * width_ + i) * all + b * width_ + k] =
                (a == b && i == k ? 1 : 0) - h * rule.a[a][b] * rate[i].slope[0];
    }
    detail::invert(all, matrix_.data());
    work_.forces += std::int64_t(width_);
  }

  template <int M>
  StepStatus take(X& x, const S& h) noexcept {
    using least::abs;
    using least::any;
    const auto& rule = GaussRule<M, S>::get();
    const std::size_t all = M * width_;
    std::array<T, widest> start, at, end;
    std::array<double, widest> middle{};
    for (std::size_t i = 0; i < n_; ++i) {
      start[i] = x.q[i];
      start[n_ + i] = -x.p[i];
    }
    start[2 * n_] = x.action.s;
    start[2 * n_ + 1] = T(1);
    const auto plain_of = [](const auto& v) { return double(value_of_number(v)); };
    for (std::size_t i = 0; i < width_; ++i) middle[i] = plain_of(start[i]);
    prepare<M>(middle, plain_of(T(x.t)), plain_of(T(h)));

    for (auto& z : z_) z = T(0);
    std::array<T, most> update;
    double start_size = 0, before = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < width_; ++i) start_size += std::abs(middle[i]);
    for (int k = 0;; ++k) {
      if (k == most_iterations) return StepStatus::solver_failed;
      for (std::size_t j = 0; j < M; ++j) {
        for (std::size_t i = 0; i < width_; ++i) at[i] = start[i] + z_[j * width_ + i];
        rates(at.data(), x.t + rule.node[j] * h, rates_.data() + j * width_);
      }
      work_.forces += M;
      ++work_.iterations;
      for (std::size_t a = 0; a < M; ++a)
        for (std::size_t i = 0; i < width_; ++i) {
          T wrong = z_[a * width_ + i];
          for (std::size_t b = 0; b < M; ++b) wrong = wrong - (h * rule.a[a][b]) * rates_[b * width_ + i];
          update[a * width_ + i] = wrong;
        }
      double size = 0, scale = start_size;
      for (std::size_t a = 0; a < all; ++a) {
        T change = matrix_[a * all] * update[0];
        for (std::size_t b = 1; b < all; ++b) change = change + matrix_[a * all + b] * update[b];
        z_[a] = z_[a] - change;
        size += size_of_number(change);
        scale += std::abs(value_of_number(z_[a]));
      }
      const double small = 8 * Precision<T>::epsilon * scale;
      if (!(size < std::numeric_limits<double>::max())) return StepStatus::solver_failed;
      if (size <= small || (size >= 0.5 * before && size <= 1e3 * small)) break;  // no better than round-off
      if (k % patience == patience - 1 && size > 1e-2 * before) {
        for (std::size_t i = 0; i < width_; ++i) {
          middle[i] = plain_of(start[i]);
          for (std::size_t j = 0; j < M; ++j) middle[i] += plain_of(z_[j * width_ + i]) / M;
        }
        prepare<M>(middle, plain_of(T(x.t + h / 2)), plain_of(T(h)));
      }
      before = size;
    }
    for (std::size_t j = 0; j < M; ++j) {
      for (std::size_t i = 0; i < width_; ++i) at[i] = start[i] + z_[j * width_ + i];
      rates(at.data(), x.t + rule.node[j] * h, rates_.data() + j * width_);
    }
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

  /// The number under derivatives, and its size with theirs.
  template <class U>
  static double value_of_number(const U& v) {
    if constexpr (requires { v.value; }) {
      return value_of_number(v.value);
    } else {
      return static_cast<double>(v);
    }
  }
  template <class U>
  static double size_of_number(const U& v) {
    if constexpr (requires { v.value; }) {
      double sum = size_of_number(v.value);
      for (const auto& slope : v.slope) sum += size_of_number(slope);
      return sum;
    } else {
      return std::abs(static_cast<double>(v));
    }
  }

  P problem_;
  std::size_t stages_, n_, width_;
  std::array<T, most> z_{}, rates_{};  ///< stages less the start, their rates
  std::array<double, most * most> matrix_{};
  Work work_;
};

}  // namespace least
