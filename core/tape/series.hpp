// Series computes the Taylor coefficients of a motion whose rates stand on a tape, by recurrences, order by order. One
// interpreter runs every program, as a loop over its steps (core/tape/series_reading.hpp), so that new equations need
// no compilation. Programs whose structure was known at compile time run unrolled instead (core/tape/unrolled.hpp).
// Bits do not depend on the instruction set. Sources: Jorba & Zou, Experimental Mathematics 14, 99 (2005); Moore,
// Interval Analysis, 1966, chapter 11; Knuth, The Art of Computer Programming 2, 4.7 (powers of series).
#pragma once

#include <memory>
#include <vector>

#include "core/tape/program.hpp"

namespace least::tape {

/// Four is a vector of four doubles. Lanes are summed by fours on every machine, so that the bits are the same.
struct alignas(32) Four {
  double lane __attribute__((vector_size(32)));
  double* begin() { return reinterpret_cast<double*>(this); }
};
/// Reads one number with a load of its own. Compilers tend to load neighbours as a pair; if these have just been stored
/// one by one, the processor has to wait until both stores are in memory.
[[gnu::always_inline]] inline double read_alone(const double& x) {
  double value = x;
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
  asm("" : "+x"(value));
#endif
  return value;
}

/// Workspace says where the coefficients of a series go: `rows` has all values of order 0, then of order 1 …, `stride`
/// numbers apart. An unrolled series keeps its slots in `lanes`: by order, the fours of the lower factors, then those
/// of the higher.
struct Workspace {
  std::size_t orders, stride;
  const double* x;  ///< the variables
  double t;
  const double* begun;  ///< order 0 of all values; null: still to be computed
  double* rows;
  Four* lanes;
};

struct UnrolledSeries;
class CloserSeries;
class SeriesReading;

class Series {
 public:
  static constexpr int most_orders = 48;

  /// Prepares series up to the order `order`, from 1 to `most_orders`. Without `unroll` the program is interpreted even
  /// where an unrolled series fits.
  Series(Program program, int order, bool unroll = true);
  Series(Series&& other) noexcept;
  ~Series();

  /// Computes the series of the variables that have the values x at the time t. `bounded`: where the program is
  /// interpreted, steep functions (core/tape/steep.hpp) are clamped to ±1e50, so that their powers do not overflow: a
  /// quotient by such a function is negligible in any case.
  void expand(const double* x, double t, bool bounded = false);
  /// Whether the program is interpreted and divides by values that may vanish.
  bool divides() const { return closer_ != nullptr; }
  /// Estimates from the first `orders` orders of the last expansion how far, in complex time, the nearest zero of a
  /// divisor lies (CloserSeries::reach); infinite where none can lie within h, and where `divides` is false.
  double reach(int orders, double h);
  /// Estimates the largest rounding error of a rate of the motion where it was expanded last; 0 where `divides` is
  /// false.
  double blur();
  /// The same as `blur` at the state of the last call of `defined`.
  double blur_of_trial();
  /// Computes the series like `expand`, but in double-double, rounded to double in the end. Requires `divides`.
  void expand_closely(const double* x, double t);
  /// Whether the rates of the motion at x are numbers.
  bool defined(const double* x, double t);
  /// The rate of a variable at the state of the last call of `defined`.
  double rate(std::size_t variable) const { return trial_[static_cast<std::size_t>(program_.rate[variable])]; }
  /// Any value at that state.
  double value(Index value) const { return trial_[static_cast<std::size_t>(value)]; }
  /// Returns x⁽ᵏ⁾/k! of the variables, 0 ≤ k ≤ order. Reading beyond the last variable, up to a multiple of four, is
  /// allowed.
  const double* coefficients(int k) const { return row(k) + Program::first_variable; }
  /// The k-th coefficient of any value, for k below the order.
  double coefficient(Index value, int k) const { return row(k)[value]; }

  int order() const { return order_; }
  std::size_t stride() const { return stride_; }  ///< numbers from one order to the next
  bool unrolled() const { return unrolled_ != nullptr; }
  std::size_t bytes() const;  ///< approximate memory
  const Program& program() const { return program_; }

 private:
  /// The numbers of the widest register. Rows of coefficients begin at multiples of it.
  struct alignas(64) Line {
    double numbers[8];
  };

  /// Computes order 0 of all values from the variables and the time in `row`.
  void begin(double* row, bool bounded = false);
  double* rows() { return rows_.data()->numbers; }
  const double* row(int k) const { return rows_.data()->numbers + static_cast<std::size_t>(k) * stride_; }

  Program program_;
  const UnrolledSeries* unrolled_;          ///< null: the program is interpreted
  std::unique_ptr<SeriesReading> reading_;  ///< then
  std::unique_ptr<CloserSeries> closer_;    ///< null unless it is interpreted and divides
  int order_;
  std::size_t stride_;
  std::vector<Line> rows_;     ///< by order, every value
  std::vector<double> trial_;  ///< order 0 of the values at the state of the last call of `defined`
  std::vector<Four> lanes_;    ///< slots of an unrolled series
};

}  // namespace least::tape
