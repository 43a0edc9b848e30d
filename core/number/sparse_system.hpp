// SparseSystem solves linear systems A x = b whose size and places of nonzero entries are known at run time, before
// their values. Rows and columns are renumbered so that these places are near the diagonal (Cuthill & McKee, from the
// far end of the graph): for a chain, even one that is closed to a ring, the cost is proportional to its length. Where
// the band is wide, the matrix is decomposed as a dense one (DenseFactors), unless it is small. Sources: Cuthill &
// McKee, Proc. 24th ACM National Conference, 157 (1969); Golub & Van Loan, Matrix Computations, 2013, 4.3.5 (band
// elimination with pivots).
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/number/dense_factors.hpp"

namespace least {

/// SparsityPattern lists, for each row, the columns that may have nonzero entries.
using SparsityPattern = std::vector<std::vector<std::uint32_t>>;

/// A SparseSystem holds one matrix or its factors, and so is not copied.
class SparseSystem {
 public:
  explicit SparseSystem(const SparsityPattern& pattern);

  std::size_t size() const { return place_.size(); }
  bool is_banded() const { return dense_ == nullptr; }
  /// The largest distance of an entry from the diagonal after the renumbering.
  std::size_t bandwidth() const { return band_; }

  /// Memory of the entries in bytes.
  std::size_t bytes() const { return sizeof(double) * (dense_ ? size() * size() : entries_.size()); }

  /// Whether the matrix is small and is treated as full, row-major.
  bool is_small() const { return small_; }

  /// Makes every entry 0.
  void clear();
  /// Adds `value` to the entry of row i and column j, which has to be in the pattern.
  void add(std::size_t i, std::size_t j, double value) {
    if (small_) {
      entries_[i * size() + j] += value;
    } else if (dense_) {
      dense_->entries()[i * size() + j] += value;
    } else {
      row(place_[i])[place_[j]] += value;
    }
  }
  /// Replaces the entries by the factors. Allocates nothing where the matrix is banded. Returns false if
  /// AskedByThread::goes_on(), which only large dense matrices ask, does.
  bool factor();
  /// Replaces b by x with A x = b; not finite where the matrix is singular. Requires `factor`.
  void solve(double* b);

 private:
  std::size_t width() const { return 3 * band_ + 1; }
  double* row(std::size_t i) { return entries_.data() + i * width() + band_ - i; }

  std::vector<std::uint32_t> place_;  ///< by row or column: its number after the renumbering
  std::size_t band_ = 0;
  bool small_ = false;
  /// By row i, the columns i − band … i + 2 band, because pivoting widens the upper half; of a small matrix all
  /// columns.
  std::vector<double> entries_;
  std::vector<std::uint32_t> pivots_;
  std::vector<double> renumbered_;  ///< a right-hand side
  std::unique_ptr<DenseFactors> dense_;
};

}  // namespace least
