// StepBatches puts steps of one rule and shape that do not depend on each other, such as the distances of all pairs of
// bodies, side by side into batches. The values that a batch computes are consecutive; the values that it reads mostly
// are, too, and are gathered where they are not. So a batch runs as many steps at a time as a register holds numbers,
// by the same rules and to the same bits as one by one.
#pragma once

#include <cstddef>
#include <vector>

#include "core/tape/program.hpp"

namespace least::tape {

/// Column says where the steps of a batch find an operand: in consecutive values from `first` on; or, if `gathered`, in
/// the values that `places` lists from `first` on. `first` is none where the steps have no such operand.
struct Column {
  Index first = none;
  bool gathered = false;

  friend bool operator==(const Column&, const Column&) = default;
  friend bool operator==(const Column& column, Index place) { return column.first == place; }
};

/// StepBatch is a Step for several steps at once.
struct StepBatch {
  Rule rule = Rule::sum;
  Op function = Op::constant;
  Column out, weighted, a, b, w, lane;
  Index first_value = 0, values = 0, first_product = 0, products = 0;
  std::size_t count = 0, room = 0;  ///< room: count rounded up to a multiple of `StepBatches::width`
  std::size_t numbers = 0;          ///< first of c, p and the factors of values and products, `room` numbers each
  std::size_t scratch = 0;  ///< where in the scratch the factors of the steps and the ends of their products begin
};

class StepBatches {
 public:
  static constexpr std::size_t width = 8;  ///< steps at a time

  struct Value {
    Column value;
  };
  struct Product {
    Column a, b, lane;
  };
  /// A part of the work of an order: a batch, or steps of the program one by one.
  struct Piece {
    bool is_batch;
    std::size_t first, count;  ///< number of the batch and 1; or first step and number of steps
  };
  /// `width` consecutive lanes: the first value of their first factors, and that of their second ones.
  struct Lanes {
    Index a, b;
  };

  /// Reorders steps, values and lanes of the program so that those of a batch stand together, and drops lanes that
  /// nothing reads. In a program with more steps of the motion than an unrolled series may have, a product that several
  /// sums contain becomes a value of its own.
  explicit StepBatches(Program& program);

  std::vector<StepBatch> batches;
  std::vector<Value> values;
  std::vector<Product> products;
  std::vector<Index> places;    ///< from which columns gather; each column is padded to whole registers
  std::vector<double> numbers;  ///< of batches
  std::vector<Piece> pieces;
  std::vector<Lanes> lanes;     ///< those of products of two values, then those of squares
  std::size_t mixed_lanes = 0;  ///< how many are products of two
  std::vector<Index> copied;    ///< values that every order copies, in this order, behind all others, for lanes
  std::size_t scratch = 0;      ///< size of the scratch of all batches

 private:
  class Arrangement;
};

}  // namespace least::tape
