// Linear systems A x = b whose size is known when they run, and whose entries that are not zero stand at places known
// beforehand. Rows and columns are renumbered so that these stand near the diagonal (Cuthill & McKee, reversed): of a
// chain, also of one that is closed to a ring, the decomposition costs what the chain is long. Where the band is as
// wide as the matrix Eigen decomposes it, unless it is small. Sources: Cuthill & McKee, Proc. 24th ACM National
// Conference, 157 (1969); Golub & Van Loan, Matrix Computations, 2013, 4.3.5 (band elimination with pivots).
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/number/dense_factors.hpp"

namespace least {

/// Of each row the columns that may have entries.
using SparsityPattern = std::vector<std::vector<std::uint32_t>>;

/// Not copied: a system holds factors of one matrix.
class SparseSystem {
 public:
  explicit SparseSystem(const SparsityPattern& pattern);

  std::size_t size() const { return place_.size(); }
  bool is_banded() const { return dense_ == nullptr; }
  /// Entries on either side of the diagonal, after the renumbering.
  std::size_t bandwidth() const { return band_; }

  /// Of its entries, in memory.
  std::size_t bytes() const { return sizeof(double) * (dense_ ? size() * size() : entries_.size()); }

  /// Small and full: its entries stand row by row.
  bool is_small() const { return small_; }

  /// Makes every entry 0.
  void clear();
  /// Adds to the entry of row i and column j, which is one of the pattern.
  void add(std::size_t i, std::size_t j, double value) {
    if (small_) {
      entries_[i * size() + j] += value;
    } else if (dense_) {
      dense_->entries()[i * size() + j] += value;
    } else {
      row(place_[i])[place_[j]] += value;
    }
  }
  /// Puts the factors in the place of the entries. Allocates nothing where the matrix is banded. False: it is not to go
  /// on (AskedByThread), which it asks where the matrix is large.
  bool factor();
  /// x in the place of b, by the factors; not finite where the matrix has no inverse.
  void solve(double* b);

 private:
  std::size_t width() const { return 3 * band_ + 1; }
  double* row(std::size_t i) { return entries_.data() + i * width() + band_ - i; }

  std::vector<std::uint32_t> place_;  ///< of each row and column among the renumbered ones
  std::size_t band_ = 0;
  bool small_ = false;
  /// Of row i the columns i − band … i + 2 band, as pivots widen the upper half; of what is small all columns.
  std::vector<double> entries_;
  std::vector<std::uint32_t> pivots_;
  std::vector<double> renumbered_;  ///< a right side
  std::unique_ptr<DenseFactors> dense_;
};

}  // namespace least
