// Square matrices of what a text says: second derivatives by velocities or momenta. Of a thousand coordinates most of
// their entries are zero whatever the values, so that the others alone are kept.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/memory_budget.hpp"
#include "core/tape/symbol.hpp"

namespace least::text {

/// The number 0, whatever the values of variables.
bool is_nothing(const Symbol& x);

class SymbolMatrix {
 public:
  struct Entry {
    std::size_t column;
    Symbol value;
  };
  using Row = std::vector<Entry>;  ///< by columns, without those that are zero

  SymbolMatrix() = default;
  /// Of zeros.
  explicit SymbolMatrix(std::size_t n) : rows_(n) {}

  std::size_t size() const { return rows_.size(); }
  bool empty() const { return rows_.empty(); }
  std::size_t entries() const;
  const Row& row(std::size_t i) const { return rows_[i]; }
  Row& row(std::size_t i) { return rows_[i]; }
  /// 0 where there is no entry.
  Symbol at(std::size_t i, std::size_t j) const;
  bool is_diagonal() const;
  /// All n² numbers, row by row.
  std::vector<Symbol> written_out() const;

 private:
  std::vector<Row> rows_;
};

/// Numbers in the places of entries, in blocks that have nothing to do with each other: what is computed of one takes
/// no more than of its blocks.
class BlockMatrix {
 public:
  struct Block {
    std::vector<std::size_t> of;  ///< rows and columns, in their order
    std::vector<double> numbers;  ///< row by row
  };
  static constexpr std::size_t most_numbers = std::size_t(1) << 17;  ///< of all blocks, zeros within them included

  /// `numbers`: of the entries, row by row. Throws tape::TooManyOperations where blocks have too many.
  BlockMatrix(const SymbolMatrix& matrix, std::span<const double> numbers);

  const std::vector<Block>& blocks() const { return blocks_; }
  /// Not finite where there is none.
  void invert();
  /// How far a symmetric matrix is from one without an inverse, whatever the units of its rows and their number: of the
  /// block that comes nearest 1/(‖A‖‖A⁻¹‖) once each row and its column have the same scale that makes their largest
  /// entry 1, 0 where there is no inverse; and of all blocks log |det A|.
  struct Regularity {
    double reciprocal_condition = 1, log_determinant = 0;
  };
  Regularity regularity() const;

 private:
  std::vector<Block> blocks_;
};

/// Of numbers in the places of entries, row by row. By Cholesky's elimination: every pivot is positive. Throws
/// tape::TooManyOperations, MemoryShortage.
bool is_positive_definite(const SymbolMatrix& matrix, std::span<const double> numbers);

/// Numbers, and not all of one sign by any change of coordinates: K of both signs is as regular as any, but nothing
/// that schemes take for granted of a natural form. All negative, it is one that was typed with a wrong sign; what
/// depends on parameters or the place is told where these are known. Throws as above.
bool is_indefinite(const SymbolMatrix& second);

/// By elimination; rows change places where a pivot is zero whatever the values. Nothing where there is no other. What
/// it takes is held meanwhile, and throws MemoryShortage; of too many operations throws tape::TooManyOperations.
std::optional<SymbolMatrix> inverse_of(SymbolMatrix a);

}  // namespace least::text
