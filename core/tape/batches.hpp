// Batches evaluates a large formula in batches, each of which applies one operation to consecutive values. The steps of
// a batch do not depend on each other, so its loop runs on wide registers. Consecutive batches of one length run
// together tile by tile, so that what they pass on stays in the cache. A sum of many terms is one step, and several
// sums run side by side. Every value comes from the same operations on the same operands as one by one, and so has the
// same bits.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/tape/operation.hpp"

namespace least::tape {

class Batches {
 public:
  /// Makes the batches of steps whose outputs are the steps `ends`; null where too few steps are alike for batches to
  /// be faster.
  static std::shared_ptr<const Batches> of(std::span<const Operation> steps, std::span<const Index> ends);

  /// out[i] is the value of ends[i] at the variables x and the time t.
  void evaluate(const double* x, double t, double* out) const noexcept;

 private:
  using Place = std::uint32_t;
  static constexpr std::size_t tile = 256;   ///< values of a batch computed at a time
  static constexpr std::size_t abreast = 8;  ///< sums that run side by side
  static constexpr Place zero = 0;           ///< the place that holds 0
  /// Where a batch reads the values of one of its operands, or writes its own.
  struct Operand {
    enum class Kind : std::uint8_t {
      in_order,   ///< consecutive from place `at`
      scattered,  ///< at the places places_[at], places_[at + 1] …
      in_runs,    ///< in runs; places_[at + n] is the first run of tile number n
      in_tile     ///< in the buffer number `at` of one tile, which the next tile overwrites
    };
    Kind kind = Kind::in_order;
    std::uint32_t at = 0;
  };
  /// `length` consecutive values from a place, or one value `length` times.
  struct Run {
    Place from = 0;
    std::uint32_t length = 0;
    bool moves = false;
  };
  struct Batch {
    Code code;
    Operand out{}, a{}, b{}, c{};
    std::uint32_t value = 0;  ///< the first of its numbers in values_, where the operation has a number
  };
  /// `number` batches that run together tile by tile; or `number` blocks of sums.
  struct Stage {
    bool sums = false;
    std::uint32_t first = 0, number = 0;
    std::uint32_t count = 0;  ///< values of each batch
  };
  /// A block of `abreast` sums side by side. From `at` on, places_ lists the heads of the sums, then the places of
  /// their terms, span by span; from `sign` on, signs_ has 1 or −1 for each term. A sum with fewer terms is padded with
  /// −1 · 0, which changes nothing.
  struct Sums {
    Place out = 0;
    std::uint32_t first_span = 0, spans = 0, at = 0, sign = 0;
  };
  /// The next `terms` terms of each sum of a block. If they are in order, the k-th terms of all sums are consecutive,
  /// and places_ has the first place only.
  struct Span {
    std::uint32_t terms = 0;
    bool in_order = false;
  };
  class Scheduler;

  static void copy(const Run& run, const double* from, double* to);
  void add_up(const Sums& sums, double* r) const noexcept;

  std::vector<Stage> stages_;
  std::vector<Batch> batches_;
  std::vector<Sums> sums_;
  std::vector<Span> spans_;
  std::vector<Run> runs_;
  std::vector<Place> places_, ends_;
  std::vector<double> values_, signs_;
  std::size_t room_ = 0;   ///< places for values that are alive at once
  std::size_t tiles_ = 0;  ///< buffers of one tile that are alive at once
};

}  // namespace least::tape
