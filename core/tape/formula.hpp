// Formula evaluates values of a tape in any number type, as a list of operations on registers. An operation costs a
// nanosecond or two, less where many are alike (core/tape/batches.hpp). An evaluation allocates memory only when its
// thread has not yet evaluated a formula of as many registers.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/number/math.hpp"
#include "core/tape/batches.hpp"

namespace least::tape {

class TermSums;
/// SharedSums are the prepared sums of the terms of a tape, by the number of the terms, for all formulas of that tape.
using SharedSums = std::map<Index, std::shared_ptr<const TermSums>>;

class Formula {
 public:
  Formula() = default;
  /// Prepares the nodes `outputs` of the tape as functions of its variables and of the time. Formulas of one tape that
  /// are given the same `shared` prepare the sums they have in common once. Throws TooManyOperations if the formula
  /// needs more registers than 16 bits can number.
  Formula(const Tape& tape, std::span<const Index> outputs, SharedSums* shared = nullptr);

  /// Writes the value of output i at the variables x and the time t to out[i]. x has an entry for every variable of the
  /// tape.
  template <class T, class S>
  void evaluate(const T* x, const S& t, T* out) const {
    if constexpr (std::is_same_v<T, double>) {
      if (batches_) return batches_->evaluate(x, t, out);
      if (registers_ <= few) {
        std::array<double, few> registers;  // NOLINT: written before it is read
        return run(x, t, registers.data(), out);
      }
    }
    thread_local std::vector<T> registers;
    if (registers.size() < registers_) registers.resize(registers_);
    run(x, t, registers.data(), out);
  }

  /// Writes the values at `count` rows, each of `width` doubles, the time and then x, to out, row by row; the values
  /// have the bits that evaluate gives.
  void evaluate_rows(const double* rows, std::size_t width, std::size_t count, double* out) const;

  std::size_t outputs() const { return outputs_.size(); }
  /// The number of operations, including those of all terms.
  std::size_t operations() const;
  bool in_batches() const { return batches_ != nullptr; }

 private:
  friend TermSums;
  using Register = std::uint16_t;
  static constexpr std::size_t few = 64;

  struct Narrow {
    Code code;
    Register out = 0, a = 0, b = 0, c = 0;
    double value = 0;
  };
  class Allocator;

  template <class T, class S>
  void run(const T* x, const S& t, T* r, T* out) const {
    using least::acos;
    using least::asin;
    using least::atan;
    using least::cos;
    using least::cosh;
    using least::exp;
    using least::log;
    using least::pow;
    using least::scaled;
    using least::select;
    using least::sin;
    using least::sinh;
    using least::sqrt;
    using least::tan;
    using least::tanh;
    for (const Narrow& s : steps_) {
      const T& a = r[s.a];
      switch (s.code) {
        case Code::constant:
          r[s.out] = T(s.value);
          break;
        case Code::variable:
          r[s.out] = x[s.a];
          break;
        case Code::time:
          r[s.out] = T(t);
          break;
        case Code::add:
          r[s.out] = a + r[s.b];
          break;
        case Code::subtract:
          r[s.out] = a - r[s.b];
          break;
        case Code::multiply:
          r[s.out] = a * r[s.b];
          break;
        case Code::divide:
          r[s.out] = a / r[s.b];
          break;
        case Code::add_constant:
          r[s.out] = a + s.value;
          break;
        case Code::from_constant:
          r[s.out] = s.value - a;
          break;
        case Code::scale:
          r[s.out] = scaled(a, s.value);
          break;
        case Code::over:
          r[s.out] = T(s.value) / a;
          break;
        case Code::power:
          r[s.out] = pow(a, s.value);
          break;
        case Code::sqrt:
          r[s.out] = sqrt(a);
          break;
        case Code::exp:
          r[s.out] = exp(a);
          break;
        case Code::log:
          r[s.out] = log(a);
          break;
        case Code::sin:
          r[s.out] = sin(a);
          break;
        case Code::cos:
          r[s.out] = cos(a);
          break;
        case Code::tan:
          r[s.out] = tan(a);
          break;
        case Code::sinh:
          r[s.out] = sinh(a);
          break;
        case Code::cosh:
          r[s.out] = cosh(a);
          break;
        case Code::tanh:
          r[s.out] = tanh(a);
          break;
        case Code::atan:
          r[s.out] = atan(a);
          break;
        case Code::asin:
          r[s.out] = asin(a);
          break;
        case Code::acos:
          r[s.out] = acos(a);
          break;
        case Code::select:
          r[s.out] = select(a < T(0), r[s.b], r[s.c]);
          break;
        case Code::add_up:
          add_up(*sums_[s.a], x, t, r, r + s.out);
          break;
        case Code::total:
          break;
      }
    }
    for (std::size_t i = 0; i < outputs_.size(); ++i) out[i] = r[outputs_[i]];
  }

  template <class T, class S>
  static void add_up(const TermSums& sums, const T* x, const S& t, const T* r, T* out);

  std::vector<Narrow> steps_;
  std::vector<Register> outputs_;
  std::vector<std::shared_ptr<const TermSums>> sums_;
  std::size_t registers_ = 0;
  std::shared_ptr<const Batches> batches_;  ///< null unless many operations are alike
};

}  // namespace least::tape

#include "core/tape/term_sums.hpp"
