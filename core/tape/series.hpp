// The Taylor series of a motion whose rates are a tape: coefficients by recurrences, order by order, in a place of
// their own. One engine runs every tape: an order is a loop over what has to be computed
// (core/tape/series_reading.hpp), so that it is no matter of compilation. Where the compiler has met the structure of
// the program, it has unrolled it (core/tape/unrolled.hpp). Bits do not depend on the instruction set. Sources: Jorba &
// Zou, Experimental Mathematics 14, 99 (2005); Moore, Interval Analysis, 1966, chapter 11; Knuth, The Art of Computer
// Programming 2, 4.7 (powers of series).
#pragma once

#include <memory>
#include <vector>

#include "core/tape/program.hpp"

namespace least::tape {

/// Lanes go by fours, whatever the machine.
struct alignas(32) Four {
  double lane __attribute__((vector_size(32)));
  double* begin() { return reinterpret_cast<double*>(this); }
};
/// A number read by itself. Compilers read by two what stands side by side; where it has just been written one by one,
/// a processor waits for that until it is in memory.
[[gnu::always_inline]] inline double read_alone(const double& x) {
  double value = x;
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
  asm("" : "+x"(value));
#endif
  return value;
}

/// Where a series stands: rows of coefficients, by order; of one that is unrolled groups of slots, by order the lower
/// factors and the higher.
struct Workspace {
  std::size_t orders, stride;
  const double* x;  ///< the variables
  double t;
  const double* begun;  ///< order 0 of all values; null: of those it is to be computed
  double* rows;
  Four* lanes;
};

struct UnrolledSeries;
class CloserSeries;
class SeriesReading;

class Series {
 public:
  static constexpr int most_orders = 48;

  /// Up to this order, at least 1 and at most `most_orders`. Unless `unroll`, the program is read in any case.
  Series(Program program, int order, bool unroll = true);
  Series(Series&& other) noexcept;
  ~Series();

  /// The series of the variables that are x at the time t. `bounded`: steep functions (core/tape/steep.hpp) are held
  /// below 1e50, so that powers of theirs are numbers: of what such a function divides little is left in any case.
  void expand(const double* x, double t, bool bounded = false);
  /// Whether formulas divide by what may vanish, of a program that the compiler does not know.
  bool divides() const { return closer_ != nullptr; }
  /// Of where it was expanded last, as CloserSeries has it: how far a divisor of the first `orders` orders may be from
  /// its zero, within h; infinite of a program that divides by nothing, or that the compiler knows.
  double reach(int orders, double h);
  /// The same: what rounding changes in a rate of the motion at most, about.
  double blur();
  /// The same where `defined` was asked for last.
  double blur_of_trial();
  /// The series as `expand` gives it, of coefficients that were computed to twice as many digits, where `reach` may be
  /// finite.
  void expand_closely(const double* x, double t);
  /// Whether the rates of the motion at x are numbers.
  bool defined(const double* x, double t);
  /// The rate of a variable where that was asked for last.
  double rate(std::size_t variable) const { return trial_[static_cast<std::size_t>(program_.rate[variable])]; }
  /// Any value there.
  double value(Index value) const { return trial_[static_cast<std::size_t>(value)]; }
  /// x⁽ᵏ⁾/k! of the variables, 0 ≤ k ≤ order; up to a multiple of four there are numbers to be read behind them.
  const double* coefficients(int k) const { return row(k) + Program::first_variable; }
  /// The same of any value, for k below the order.
  double coefficient(Index value, int k) const { return row(k)[value]; }

  int order() const { return order_; }
  std::size_t stride() const { return stride_; }  ///< of coefficients, from one order to the next
  bool unrolled() const { return unrolled_ != nullptr; }
  std::size_t bytes() const;  ///< in memory, about
  const Program& program() const { return program_; }

 private:
  /// As many numbers as one register holds at most; rows begin with one.
  struct alignas(64) Line {
    double numbers[8];
  };

  /// Order 0, from the variables and the time that stand there.
  void begin(double* row, bool bounded = false);
  double* rows() { return rows_.data()->numbers; }
  const double* row(int k) const { return rows_.data()->numbers + static_cast<std::size_t>(k) * stride_; }

  Program program_;
  const UnrolledSeries* unrolled_;          ///< none: the program is read
  std::unique_ptr<SeriesReading> reading_;  ///< then
  std::unique_ptr<CloserSeries> closer_;    ///< of one that is read and divides
  int order_;
  std::size_t stride_;
  std::vector<Line> rows_;     ///< by order, every value
  std::vector<double> trial_;  ///< order 0 of the values at the state that was asked for last
  std::vector<Four> lanes_;    ///< of a series that is unrolled
};

}  // namespace least::tape
