// Newton's method for the equations of a step on a scene whose size is known only at run time: derivatives along a few
// directions at a time, and rounds that keep the matrix.
#pragma once

#include <algorithm>
#include <limits>
#include <tuple>
#include <type_traits>
#include <vector>

#include "core/newton_matrix.hpp"
#include "core/number/asked_by_thread.hpp"

namespace least {

/// A number with derivatives along a few directions, for a few columns of a matrix at a time.
using FewDirections = Dual<double, 4>;
inline constexpr std::size_t directions_at_once = std::tuple_size_v<decltype(FewDirections::slope)>;

/// fill_jacobian writes the Jacobian of `equations(z, values)` to the entries of a matrix; `trial` and `values` have
/// room for as many numbers. False: the computation is to end (AskedByThread), which is asked only for many unknowns.
template <class T, class Equations>
bool fill_jacobian(const T* z, std::vector<FewDirections>& trial, std::vector<FewDirections>& values,
                   NewtonMatrix& jacobian, Equations&& equations) {
  const std::size_t n = jacobian.size();
  double* const entries = jacobian.entries();
  for (std::size_t first = 0; first < n; first += directions_at_once) {
    if (jacobian.is_large() && !AskedByThread::goes_on()) return false;
    const std::size_t end = std::min(n, first + directions_at_once);
    for (std::size_t i = 0; i < n; ++i) {
      trial[i] = FewDirections(plain_number(z[i]));
      if (i >= first && i < end) trial[i].slope[i - first] = 1;
    }
    equations(trial.data(), values.data());
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t k = first; k < end; ++k) entries[i * n + k] = values[i].slope[k - first];
  }
  return true;
}

/// late_rounds is the number of additional rounds after convergence for derivatives in dual numbers.
template <class T>
inline constexpr int late_rounds = std::is_same_v<T, double> ? 0 : 1;

/// SmallNewton is Newton's method in numbers T, with a matrix of plain numbers that is kept as long as rounds contract
/// well. For dual numbers no matrix is kept, and derivatives converge a round after the values.
template <class T>
class SmallNewton {
 public:
  explicit SmallNewton(std::size_t unknowns)
      : update(unknowns), matrix_(unknowns), wrong_(unknowns), trial_(unknowns), row_(unknowns) {}

  std::vector<T> update;  ///< correction to subtract from the unknowns

  /// To be called before the first round of a solution.
  void begin() {
    outworn_ = true;
    before_ = std::numeric_limits<double>::infinity();
  }
  /// Computes `update` at z. `in_numbers(z, wrong)` writes the residual in T; `in_rows` the same in plain numbers with
  /// derivatives along a few directions, for the matrix. False: the computation is to end (AskedByThread), which is
  /// asked only for many unknowns.
  template <class Numbers, class Rows>
  bool look(const T* z, Numbers&& in_numbers, Rows&& in_rows) {
    fresh_ = outworn_;
    if (outworn_ && (!fill_jacobian(z, trial_, row_, matrix_, in_rows) || !matrix_.factor())) return false;
    if (matrix_.is_large() && !AskedByThread::goes_on()) return false;
    in_numbers(z, wrong_.data());
    matrix_.solve(wrong_.data(), update.data());
    return true;
  }
  /// Takes the size of the last update, and returns an estimate of the remaining error of the unknowns. If that round
  /// computed its own matrix, the estimate is 0, since the error is quadratically small in the update.
  double left(double changed) {
    rate_ = changed / before_;
    outworn_ = late_rounds<T> > 0 || rate_ > worst_rate;
    before_ = changed;
    return fresh_ ? 0 : changed * std::min(rate_, 1.0);
  }
  /// Whether that update was only round-off, as it is once rounds no longer make updates smaller; `size` is the size
  /// that round-off is relative to.
  bool is_rounding(double size) const {
    return rate_ >= 0.5 && before_ <= 8e3 * std::numeric_limits<double>::epsilon() * size;
  }

 private:
  static constexpr double worst_rate = 1e-2;

  NewtonMatrix matrix_;
  bool outworn_ = true, fresh_ = true;  ///< whether the next round computes a matrix; whether this one did
  double before_ = 0, rate_ = 0;        ///< size of the last update, and its ratio to the one before
  std::vector<T> wrong_;
  std::vector<FewDirections> trial_, row_;
};

}  // namespace least
