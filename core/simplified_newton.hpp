// Newton's method with one matrix for many rounds, for systems whose number of unknowns is known only at run time. The
// matrix consists of plain numbers, so derivatives carried by dual numbers converge with the solution, round by round.
// Source: Hairer & Wanner, Solving Ordinary Differential Equations II, 1996, IV.8.
#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "core/newton_matrix.hpp"
#include "core/number/asked_by_thread.hpp"

namespace least {

/// SimplifiedNewton solves systems of `unknowns` equations. It allocates nothing after construction.
template <class T>
class SimplifiedNewton {
 public:
  explicit SimplifiedNewton(std::size_t unknowns) : matrix(unknowns), wrong_(unknowns), update_(unknowns) {}

  NewtonMatrix matrix;

  /// Solves residual(z) = 0 from the guess z. `residual(z, wrong)` writes the residual to `wrong`. `prepare(z)`
  /// computes and factors the Jacobian at z in `matrix`, first at the guess and again where the rounds contract slowly;
  /// it returns false where the computation is to end. The rounds end when Σ weight(a)·|change_a| is lost in the
  /// rounding of size + Σ weight(a)·|z_a|; `weight(a)` brings unknown a to the common unit of these sums. Returns
  /// solver_failed, and z is not a solution, if the rounds do not converge, or if there are many unknowns and the
  /// thread is not to go on (AskedByThread).
  template <class Weight, class Residual, class Prepare>
  StepStatus solve(T* z, double size, Weight&& weight, Residual&& residual, Prepare&& prepare, Work& work) noexcept {
    double before = std::numeric_limits<double>::infinity();
    if (!prepare(z)) return StepStatus::solver_failed;
    for (int k = 0; k < most_rounds; ++k) {
      if (matrix.is_large() && !AskedByThread::goes_on()) return StepStatus::solver_failed;
      ++work.iterations;
      const T* const change = update(z, residual);
      double changed = 0, scale = size;
      for (std::size_t a = 0; a < update_.size(); ++a) {
        z[a] = z[a] - change[a];
        changed += weight(a) * size_with_slopes(change[a]);
        scale += weight(a) * std::abs(plain_number(z[a]));
      }
      const double small = 8 * Precision<T>::epsilon * scale;
      if (!(changed < std::numeric_limits<double>::max())) return StepStatus::solver_failed;
      if (changed <= small || (changed >= 0.5 * before && changed <= 1e3 * small))
        return StepStatus::ok;  // no better than round-off
      if (k % patience == patience - 1 && changed > 1e-2 * before && !prepare(z)) return StepStatus::solver_failed;
      before = changed;
    }
    return StepStatus::solver_failed;
  }
  /// update returns J⁻¹·residual(z) with the current matrix J; the list is valid until the next call.
  template <class Residual>
  const T* update(const T* z, Residual&& residual) {
    residual(z, wrong_.data());
    matrix.solve(wrong_.data(), update_.data());
    return update_.data();
  }

 private:
  static constexpr int most_rounds = 60, patience = 6;

  std::vector<T> wrong_, update_;
};

}  // namespace least
