// Newton's method with one matrix for many rounds, for systems whose number of unknowns is known only when they run.
// The matrix is made of plain numbers, so derivatives that ride along converge with the solution, round by round.
// Source: Hairer & Wanner, Solving Ordinary Differential Equations II, 1996, IV.8.
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "core/newton.hpp"

namespace least {

/// For at most Most unknowns. Does not allocate.
template <class T, std::size_t Most>
class SimplifiedNewton {
 public:
  /// Row by row, of as many unknowns as there are: what `prepare` leaves there and inverts.
  std::array<double, Most * Most> matrix{};

  void invert(std::size_t count) { detail::invert(count, matrix.data()); }

  /// Solves residual(z) = 0 for `count` unknowns from the guess z: `residual(z, wrong)` writes what is wrong with z.
  /// `prepare(z)` makes the inverse of the Jacobian at z; called at the guess, and anew where the rounds contract
  /// badly. `size`: of what the unknowns are known against, beside themselves: ends where an update is lost in rounding
  /// of that. `weight(a)`: what brings the unknown a to the unit in which sizes are added up. On failure z is not a
  /// solution.
  template <class Weight, class Residual, class Prepare>
  StepStatus solve(std::size_t count, T* z, double size, Weight&& weight, Residual&& residual, Prepare&& prepare,
                   Work& work) noexcept {
    std::array<T, Most> wrong;
    double before = std::numeric_limits<double>::infinity();
    prepare(z);
    for (int k = 0; k < most_rounds; ++k) {
      residual(z, wrong.data());
      ++work.iterations;
      double changed = 0, scale = size;
      for (std::size_t a = 0; a < count; ++a) {
        T change = matrix[a * count] * wrong[0];
        for (std::size_t b = 1; b < count; ++b) change = change + matrix[a * count + b] * wrong[b];
        z[a] = z[a] - change;
        changed += weight(a) * size_with_slopes(change);
        scale += weight(a) * std::abs(plain_number(z[a]));
      }
      const double small = 8 * Precision<T>::epsilon * scale;
      if (!(changed < std::numeric_limits<double>::max())) return StepStatus::solver_failed;
      if (changed <= small || (changed >= 0.5 * before && changed <= 1e3 * small))
        return StepStatus::ok;  // no better than round-off
      if (k % patience == patience - 1 && changed > 1e-2 * before) prepare(z);
      before = changed;
    }
    return StepStatus::solver_failed;
  }

 private:
  static constexpr int most_rounds = 60, patience = 6;
};

}  // namespace least
