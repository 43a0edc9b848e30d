// Newton's method for the equations of a step on a scene whose size is known when it runs: their derivatives in a few
// directions at a time, and rounds with a matrix of their own.
#pragma once

#include <algorithm>
#include <limits>
#include <tuple>
#include <type_traits>
#include <vector>

#include "core/newton_matrix.hpp"
#include "core/number/asked_by_thread.hpp"

namespace least {

/// Directions that a matrix is made of at a time.
using FewDirections = Dual<double, 4>;
inline constexpr std::size_t directions_at_once = std::tuple_size_v<decltype(FewDirections::slope)>;

/// The derivatives of `equations(z, values)` by the unknowns, as the entries of a matrix; `trial` and `values` have
/// room for as many numbers. False: it is not to go on (AskedByThread), which it asks where there are many.
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

/// Rounds that go on once the solution is there.
template <class T>
inline constexpr int late_rounds = std::is_same_v<T, double> ? 0 : 1;

/// Newton's method in numbers T, with a matrix of plain numbers that is kept as long as rounds contract well:
/// derivatives that ride along, for which none is kept, settle a round after the numbers.
template <class T>
class SmallNewton {
 public:
  explicit SmallNewton(std::size_t unknowns)
      : update(unknowns), matrix_(unknowns), wrong_(unknowns), trial_(unknowns), row_(unknowns) {}

  std::vector<T> update;  ///< by how much the unknowns are off

  /// Before the first round of a solution.
  void begin() {
    outworn_ = true;
    before_ = std::numeric_limits<double>::infinity();
  }
  /// `in_numbers(z, wrong)`: the equations in T at z; `in_rows`: the same of plain numbers in a few directions, of
  /// which a matrix is made. False: it is not to go on (AskedByThread), which it asks where there are many unknowns.
  template <class Numbers, class Rows>
  bool look(const T* z, Numbers&& in_numbers, Rows&& in_rows) {
    fresh_ = outworn_;
    if (outworn_ && (!fill_jacobian(z, trial_, row_, matrix_, in_rows) || !matrix_.factor())) return false;
    if (matrix_.is_large() && !AskedByThread::goes_on()) return false;
    in_numbers(z, wrong_.data());
    matrix_.solve(wrong_.data(), update.data());
    return true;
  }
  /// Hears how large an update was, and says about how far off it leaves the unknowns: what a round with a matrix of
  /// its own leaves is less than is known of them, where the update itself is small.
  double left(double changed) {
    rate_ = changed / before_;
    outworn_ = late_rounds<T> > 0 || rate_ > worst_rate;
    before_ = changed;
    return fresh_ ? 0 : changed * std::min(rate_, 1.0);
  }
  /// Whether that update was no better than round-off, as it is where rounds no longer make updates smaller; `size`: of
  /// what the unknowns are known against.
  bool is_rounding(double size) const {
    return rate_ >= 0.5 && before_ <= 8e3 * std::numeric_limits<double>::epsilon() * size;
  }

 private:
  static constexpr double worst_rate = 1e-2;

  NewtonMatrix matrix_;
  bool outworn_ = true, fresh_ = true;  ///< whether the next round makes a matrix; whether this one did
  double before_ = 0, rate_ = 0;        ///< the size of the last update, and beside the one before
  std::vector<T> wrong_;
  std::vector<FewDirections> trial_, row_;
};

}  // namespace least
