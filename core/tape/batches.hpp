// The steps of a large formula in batches: of one operation each, on values that stand one after the other. A batch
// waits for nothing of itself, so that its loop runs on the wide registers of the machine. Batches that follow one
// another on values of the same length run tile by tile, so that what passes between them stays near the processor; a
// sum of many terms is one step, and sums run beside each other. Every value is computed by the same operations from
// the same operands as one after the other: to the last bit the same.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/tape/operation.hpp"

namespace least::tape {

class Batches {
 public:
  /// Of steps whose values at `ends` are asked for; nothing where there are too few alike for it to be faster.
  static std::shared_ptr<const Batches> of(std::span<const Operation> steps, std::span<const Index> ends);

  /// out[i] is the value of ends[i] at the variables x and the time t.
  void evaluate(const double* x, double t, double* out) const noexcept;

 private:
  using Place = std::uint32_t;
  static constexpr std::size_t tile = 256;   ///< values of a batch that are computed at a time
  static constexpr std::size_t abreast = 8;  ///< sums that run beside each other
  static constexpr Place zero = 0;           ///< a place that holds 0
  /// Where a batch reads the values of one of its operands, or writes its own.
  struct Operand {
    enum class Kind : std::uint8_t {
      in_order,   ///< one after the other from `at`
      scattered,  ///< at places_[at], places_[at + 1] …
      in_runs,    ///< in the runs of which places_[at + n] is the first of tile number n
      in_tile     ///< in the tile number `at`, of which the next tile of the same batches takes the place
    };
    Kind kind = Kind::in_order;
    std::uint32_t at = 0;
  };
  /// Values one after the other from a place, or one value so many times.
  struct Run {
    Place from = 0;
    std::uint32_t length = 0;
    bool moves = false;
  };
  struct Batch {
    Code code;
    Operand out{}, a{}, b{}, c{};
    std::uint32_t value = 0;  ///< the first of its numbers in values_, where the operation has one
  };
  /// Batches that run together, tile by tile; or sums, so many times `abreast` of them.
  struct Stage {
    bool sums = false;
    std::uint32_t first = 0, number = 0;
    std::uint32_t count = 0;  ///< of the values of each batch
  };
  /// Sums beside each other. In places_, from `at`, where each begins, then the places of their terms, span by span; in
  /// signs_, from `sign`, 1 or −1 for each term. Short ones end with −0 · 0, which changes nothing.
  struct Sums {
    Place out = 0;
    std::uint32_t first_span = 0, spans = 0, at = 0, sign = 0;
  };
  /// The next terms of sums beside each other, so many of each. In order: each time one after the other from a place,
  /// which alone is in places_.
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
  std::size_t room_ = 0;   ///< values that stand at once
  std::size_t tiles_ = 0;  ///< that stand at once
};

}  // namespace least::tape
