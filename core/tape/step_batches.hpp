// Steps of a program that are alike, side by side: those of one rule and shape that do not wait for each other, as the
// distances of all pairs of bodies. What they make stands one after the other in a row of values; what they read mostly
// does, too, and is gathered where it does not. So they are computed by as many at a time as a register holds, by the
// rules that steps one by one follow, to the same bits.
#pragma once

#include <cstddef>
#include <vector>

#include "core/tape/program.hpp"

namespace least::tape {

/// Where the steps of a batch find an operand: in values from `first` on, one after the other; or, each for itself, at
/// places that stand from `first` on in a list. `first` is none where they have no such operand.
struct Column {
  Index first = none;
  bool gathered = false;

  friend bool operator==(const Column&, const Column&) = default;
  friend bool operator==(const Column& column, Index place) { return column.first == place; }
};

/// As Step, of several at once.
struct StepBatch {
  Rule rule = Rule::sum;
  Op function = Op::constant;
  Column out, weighted, a, b, w, lane;
  Index first_value = 0, values = 0, first_product = 0, products = 0;
  std::size_t count = 0, room = 0;  ///< room: filled up to a multiple of `StepBatches::width`
  std::size_t numbers = 0;  ///< where c, p and the factors of values and products begin, each of them `room` long
  std::size_t scratch = 0;  ///< where there is room for the factors of the steps and for the ends of their products
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
  /// What is done one after the other in each order: a batch, or steps of the program.
  struct Piece {
    bool is_batch;
    std::size_t first, count;  ///< the number of the batch and 1; or a first step and how many
  };
  /// As many lanes as `width`, one after the other: where the first factors of them begin, and the second ones.
  struct Lanes {
    Index a, b;
  };

  /// Puts steps, values and lanes of the program in an order in which those of a batch stand together, and leaves out
  /// what nothing reads. A product that several sums have becomes a value of its own where the motion takes more steps
  /// than a series that is unrolled has.
  explicit StepBatches(Program& program);

  std::vector<StepBatch> batches;
  std::vector<Value> values;
  std::vector<Product> products;
  std::vector<Index> places;    ///< that columns gather from; behind each column as many as fill it up
  std::vector<double> numbers;  ///< of batches
  std::vector<Piece> pieces;
  std::vector<Lanes> lanes;     ///< those of products of two, then those of squares
  std::size_t mixed_lanes = 0;  ///< how many of the former
  std::vector<Index> copied;    ///< values that are copied behind all others in every order, as lanes need them
  std::size_t scratch = 0;      ///< numbers that batches need while they are computed

 private:
  class Arrangement;
};

}  // namespace least::tape
