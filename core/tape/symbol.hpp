// A number that records: arithmetic with symbols writes a tape. Mechanics generic in the number, evaluated in it, leave
// their equations of motion there. It has no value, so nothing can branch on it: a comparison is recorded, too. What is
// made of constants alone is a constant and never written; parameters are numbers, so what follows from them is
// computed here, once, to twice the digits of a double but for exponents: reference solutions read the same tapes.
#pragma once

#include <utility>

#include "core/number/math.hpp"
#include "core/tape/double_double.hpp"
#include "core/tape/tape.hpp"

namespace least {

class Symbol {
 public:
  constexpr Symbol() = default;
  constexpr Symbol(double constant) : constant_(constant) {}  // NOLINT: a number like any other
  explicit constexpr Symbol(const DoubleDouble& constant) : constant_(constant) {}
  static Symbol time(tape::Tape& tape) { return {tape, tape.write({.op = tape::Op::time})}; }
  static Symbol variable(tape::Tape& tape, std::size_t i) {
    return {tape, tape.write({.op = tape::Op::variable, .value = static_cast<double>(i)})};
  }

  /// What stands there.
  static Symbol at(tape::Tape& tape, tape::Index i) {
    return tape[i].op == tape::Op::constant ? Symbol(DoubleDouble(tape[i].value, tape[i].low)) : Symbol(tape, i);
  }

  bool is_constant() const { return !tape_; }
  /// Where it stands, if it is no constant.
  tape::Index place() const { return node_; }
  double constant() const { return constant_.high(); }
  /// Where it stands on the tape: a constant is written.
  tape::Index on(tape::Tape& tape) const {
    return tape_ ? node_ : tape.write({.op = tape::Op::constant, .value = constant_.high(), .low = constant_.low()});
  }

  friend Symbol operator+(const Symbol& a, const Symbol& b);
  friend Symbol operator-(const Symbol& a, const Symbol& b);
  friend Symbol operator*(const Symbol& a, const Symbol& b);
  friend Symbol operator/(const Symbol& a, const Symbol& b);
  Symbol operator-() const { return Symbol(-1) * *this; }
  Symbol& operator+=(const Symbol& b) { return *this = *this + b; }
  Symbol& operator-=(const Symbol& b) { return *this = *this - b; }
  Symbol& operator*=(const Symbol& b) { return *this = *this * b; }
  Symbol& operator/=(const Symbol& b) { return *this = *this / b; }

  friend Symbol sqrt(const Symbol& x);
  /// A whole exponent up to `most_factors` is a product.
  friend Symbol pow(const Symbol& x, double exponent);
  friend Symbol pow(const Symbol& x, const Symbol& exponent);
  /// x^exponent where the exponent may yet become a number; pow makes it exp(exponent log x) at once.
  friend Symbol raise(const Symbol& x, const Symbol& exponent);
  friend Symbol exp(const Symbol& x);
  friend Symbol log(const Symbol& x);
  friend Symbol sin(const Symbol& x);
  friend Symbol cos(const Symbol& x);
  friend Symbol tan(const Symbol& x);
  friend Symbol sinh(const Symbol& x);
  friend Symbol cosh(const Symbol& x);
  friend Symbol tanh(const Symbol& x);
  friend Symbol atan(const Symbol& x);
  friend Symbol asin(const Symbol& x);
  friend Symbol acos(const Symbol& x);
  friend std::pair<Symbol, Symbol> sincos(const Symbol& x) { return {sin(x), cos(x)}; }

  /// A comparison: whether `difference` is negative, or is not.
  struct Mask;
  friend Mask operator<(const Symbol& a, const Symbol& b);
  friend Mask operator>(const Symbol& a, const Symbol& b);
  friend Mask operator<=(const Symbol& a, const Symbol& b);
  friend Mask operator>=(const Symbol& a, const Symbol& b);
  friend Symbol select(const Mask& mask, const Symbol& yes, const Symbol& no);
  friend Symbol abs(const Symbol& x);

  static constexpr int most_factors = 16;

 private:
  friend struct Recorder;
  Symbol(tape::Tape& tape, tape::Index node) : tape_(&tape), node_(node) {}

  tape::Tape* tape_ = nullptr;  ///< none: a constant
  tape::Index node_ = tape::none;
  DoubleDouble constant_{};
};

struct Symbol::Mask {
  Symbol difference;
  bool negated = false;
  Mask operator!() const { return {difference, !negated}; }
};

}  // namespace least
