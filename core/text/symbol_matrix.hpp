// Sparse square matrices of symbols: second derivatives by velocities or momenta. With a thousand coordinates most
// entries are identically zero, and only the others are stored.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/memory_budget.hpp"
#include "core/tape/symbol.hpp"

namespace least::text {

/// is_nothing tells whether x is the constant 0.
bool is_nothing(const Symbol& x);

/// SymbolMatrix is an n × n matrix of symbols that stores no zeros.
class SymbolMatrix {
 public:
  struct Entry {
    std::size_t column;
    Symbol value;
  };
  using Row = std::vector<Entry>;  ///< ordered by column, without zeros

  SymbolMatrix() = default;
  /// The n × n zero matrix.
  explicit SymbolMatrix(std::size_t n) : rows_(n) {}

  std::size_t size() const { return rows_.size(); }
  bool empty() const { return rows_.empty(); }
  std::size_t entries() const;
  const Row& row(std::size_t i) const { return rows_[i]; }
  Row& row(std::size_t i) { return rows_[i]; }
  /// at(i, j) returns the entry, 0 where none is stored.
  Symbol at(std::size_t i, std::size_t j) const;
  bool is_diagonal() const;
  /// written_out() returns all n² entries, row-major.
  std::vector<Symbol> written_out() const;

 private:
  std::vector<Row> rows_;
};

/// BlockMatrix is a matrix of numbers, split into the diagonal blocks that are not coupled with one another, so that
/// the work grows with the size of the blocks only.
class BlockMatrix {
 public:
  struct Block {
    std::vector<std::size_t> of;  ///< numbers of its rows and columns, ascending
    std::vector<double> numbers;  ///< row-major
  };
  /// Limit for all blocks together, with the zeros in them
  static constexpr std::size_t most_numbers = std::size_t(1) << 17;

  /// `numbers` are the values of the stored entries, row by row. Throws tape::TooManyOperations beyond most_numbers.
  BlockMatrix(const SymbolMatrix& matrix, std::span<const double> numbers);

  const std::vector<Block>& blocks() const { return blocks_; }
  /// invert() replaces the matrix by its inverse; the numbers are not finite where there is none.
  void invert();
  /// Regularity measures how far a symmetric matrix is from a singular one, independently of units and of size.
  /// reciprocal_condition is the smallest 1/(‖A‖‖A⁻¹‖) of all blocks, each scaled symmetrically so that the largest
  /// entry of every row is 1; 0 for a singular block. log_determinant is log |det A| of the whole matrix.
  struct Regularity {
    double reciprocal_condition = 1, log_determinant = 0;
  };
  Regularity regularity() const;

 private:
  std::vector<Block> blocks_;
};

/// is_positive_definite takes the values of the stored entries, row by row, and tells whether all pivots of Cholesky's
/// factorization are positive. Throws tape::TooManyOperations, MemoryShortage.
bool is_positive_definite(const SymbolMatrix& matrix, std::span<const double> numbers);

/// is_indefinite tells whether a matrix of constants is neither positive nor negative definite. Schemes assume K ≥ 0 of
/// a natural form, so that an indefinite K makes a form general, though it may be regular. A negative definite one has
/// been typed with a wrong sign; this, and matrices that depend on parameters or q, are judged where the numbers are
/// known. Throws as above.
bool is_indefinite(const SymbolMatrix& second);

/// inverse_of returns the inverse by elimination, exchanging rows where a pivot is identically zero; nothing where no
/// pivot is left. The memory it needs is held meanwhile. Throws MemoryShortage, tape::TooManyOperations.
std::optional<SymbolMatrix> inverse_of(SymbolMatrix a);

}  // namespace least::text
