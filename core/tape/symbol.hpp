// Symbol is a number type that records: arithmetic with symbols appends operations to a tape. Mechanics that are a
// template of the number type, evaluated with symbols, leave their equations of motion on the tape. A symbol has no
// value, so code cannot branch on it; a comparison is recorded as an operation, too. An expression of constants and
// parameters alone is folded to one constant and not written. Constants, but for exponents, have twice the digits of a
// double, because reference solutions read the same tapes.
#pragma once

#include <cmath>
#include <type_traits>
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
  static constexpr Symbol time(tape::Tape& tape) { return {tape, tape.write({.op = tape::Op::time})}; }
  static constexpr Symbol variable(tape::Tape& tape, std::size_t i) {
    return {tape, tape.write({.op = tape::Op::variable, .value = static_cast<double>(i)})};
  }

  /// Sum number `sum` of the terms that the tape keeps under the number `terms` (Tape::keep).
  static Symbol total(tape::Tape& tape, tape::Index terms, tape::Index sum) {
    return {tape,
            tape.write({.op = tape::Op::total, .value = static_cast<double>(sum), .low = static_cast<double>(terms)})};
  }

  /// The symbol of node i; a constant symbol if the node is a constant.
  static constexpr Symbol at(tape::Tape& tape, tape::Index i) {
    return tape[i].op == tape::Op::constant ? Symbol(DoubleDouble(tape[i].value, tape[i].low)) : Symbol(tape, i);
  }

  constexpr bool is_constant() const { return !tape_; }
  /// The node of the symbol; none if it is a constant.
  constexpr tape::Index place() const { return node_; }
  constexpr double constant() const { return constant_.high(); }
  /// The node of the symbol on the tape; a constant is written to the tape first.
  constexpr tape::Index on(tape::Tape& tape) const {
    return tape_ ? node_ : tape.write({.op = tape::Op::constant, .value = constant_.high(), .low = constant_.low()});
  }

  friend constexpr Symbol operator+(const Symbol& a, const Symbol& b);
  friend constexpr Symbol operator-(const Symbol& a, const Symbol& b);
  friend constexpr Symbol operator*(const Symbol& a, const Symbol& b);
  friend constexpr Symbol operator/(const Symbol& a, const Symbol& b);
  constexpr Symbol operator-() const { return Symbol(-1) * *this; }
  constexpr Symbol& operator+=(const Symbol& b) { return *this = *this + b; }
  constexpr Symbol& operator-=(const Symbol& b) { return *this = *this - b; }
  constexpr Symbol& operator*=(const Symbol& b) { return *this = *this * b; }
  constexpr Symbol& operator/=(const Symbol& b) { return *this = *this / b; }

  friend constexpr Symbol sqrt(const Symbol& x);
  /// x^exponent; whole exponents from 0 to `most_factors` are written as products.
  friend constexpr Symbol pow(const Symbol& x, double exponent);
  friend constexpr Symbol pow(const Symbol& x, const Symbol& exponent);
  /// x^exponent as Op::raise, so that a substitution can still make the exponent a number; pow writes exp(exponent log
  /// x) at once.
  friend constexpr Symbol raise(const Symbol& x, const Symbol& exponent);
  friend constexpr Symbol exp(const Symbol& x);
  friend constexpr Symbol log(const Symbol& x);
  friend constexpr Symbol sin(const Symbol& x);
  friend constexpr Symbol cos(const Symbol& x);
  friend constexpr Symbol tan(const Symbol& x);
  friend constexpr Symbol sinh(const Symbol& x);
  friend constexpr Symbol cosh(const Symbol& x);
  friend constexpr Symbol tanh(const Symbol& x);
  friend constexpr Symbol atan(const Symbol& x);
  friend constexpr Symbol asin(const Symbol& x);
  friend constexpr Symbol acos(const Symbol& x);
  friend constexpr std::pair<Symbol, Symbol> sincos(const Symbol& x) { return {sin(x), cos(x)}; }

  /// The result of a comparison: `difference` < 0, or the opposite if `negated`.
  struct Mask;
  friend constexpr Mask operator<(const Symbol& a, const Symbol& b);
  friend constexpr Mask operator>(const Symbol& a, const Symbol& b);
  friend constexpr Mask operator<=(const Symbol& a, const Symbol& b);
  friend constexpr Mask operator>=(const Symbol& a, const Symbol& b);
  friend constexpr Symbol select(const Mask& mask, const Symbol& yes, const Symbol& no);
  friend constexpr Symbol abs(const Symbol& x);

  static constexpr int most_factors = 16;

 private:
  friend struct Recorder;
  constexpr Symbol(tape::Tape& tape, tape::Index node) : tape_(&tape), node_(node) {}

  tape::Tape* tape_ = nullptr;  ///< null for a constant
  tape::Index node_ = tape::none;
  DoubleDouble constant_{};
};

struct Symbol::Mask {
  Symbol difference;
  bool negated = false;
  constexpr Mask operator!() const { return {difference, !negated}; }
};

/// Recorder writes the nodes of operations and recognizes the operands for which a simpler node will do.
struct Recorder {
  using Index = tape::Index;
  using Node = tape::Node;
  using Op = tape::Op;

  static constexpr Symbol unary(Op op, const Symbol& x, double value = 0) {
    return {*x.tape_, x.tape_->write({.op = op, .a = x.node_, .value = value})};
  }
  static constexpr Symbol binary(Op op, const Symbol& a, const Symbol& b) {
    tape::Tape& tape = a.tape_ ? *a.tape_ : *b.tape_;
    const Index left = a.on(tape), right = b.on(tape);
    return {tape, tape.write({.op = op, .a = left, .b = right})};
  }
  static constexpr Symbol select(const Symbol& difference, const Symbol& yes, const Symbol& no) {
    tape::Tape& tape = *difference.tape_;
    const Index first = yes.on(tape);
    Index second = no.on(tape);
    // A NaN difference would select `no` silently. Adding 0·difference to `no` makes the result NaN, too.
    if (tape[difference.node_].partial && !same(difference, no)) {
      const Symbol nothing = binary(Op::multiply, Symbol(0), difference);
      second = (no.is_constant() && no.constant() == 0 ? nothing : binary(Op::add, no, nothing)).on(tape);
    }
    return {tape, tape.write({.op = Op::select, .a = difference.node_, .b = first, .c = second})};
  }
  /// The node of x; a default node if x is a constant.
  static constexpr Node node(const Symbol& x) { return x.tape_ ? (*x.tape_)[x.node_] : Node{}; }
  static constexpr Node node(const Symbol& of, Index i) { return (*of.tape_)[i]; }
  static constexpr Symbol at(const Symbol& of, Index i) { return Symbol::at(*of.tape_, i); }
  /// The constant `exact`; its double `plain` where double-double arithmetic gave a value that is not finite.
  static constexpr Symbol constant(double plain, const DoubleDouble& exact) {
    return Symbol(std::isfinite(exact.high() + exact.low()) ? exact : DoubleDouble(plain));
  }
  /// f of the constant x in double-double. A constant expression cannot call the quad library and takes `plain`, f in
  /// double.
  static constexpr Symbol function(Op f, const Symbol& x, double plain) {
    return std::is_constant_evaluated() ? Symbol(plain) : constant(plain, elementary(f, x.constant_));
  }
  static constexpr bool same(const Symbol& a, const Symbol& b) {
    return a.tape_ && a.tape_ == b.tape_ && a.node_ == b.node_;
  }

  /// Returns −x if x is c u with a constant c < 0; otherwise a constant.
  static constexpr Symbol negated(const Symbol& x) {
    const Node n = node(x);
    if (n.op != Op::multiply || node(x, n.a).op != Op::constant || !(node(x, n.a).value < 0)) return {};
    return -at(x, n.a) * at(x, n.b);
  }

  /// Returns whether x is a node uᵖ (Op::power) or √u, and then sets `base` to u and `exponent` to p.
  static constexpr bool is_power(const Symbol& x, Symbol& base, double& exponent) {
    const Node n = node(x);
    if (n.op != Op::power && n.op != Op::sqrt) return false;
    base = at(x, n.a);
    exponent = n.op == Op::sqrt ? 0.5 : n.value;
    return true;
  }

  /// Returns 1/x for products x of cosh² u and constants by 1/cosh² u = 1 − tanh² u, which does not overflow where
  /// cosh² u does; for any other x a constant. The rounding error of the result is relative to 1, not to the result, so
  /// the result must not be multiplied by anything that grows like x.
  static constexpr Symbol inverse(const Symbol& x) {
    const Node n = node(x);
    if (n.op != Op::multiply) return {};
    if (n.a == n.b && node(x, n.a).op == Op::cosh) {
      const Symbol t = tanh(at(x, node(x, n.a).a));
      return Symbol(1) - t * t;
    }
    const Symbol a = at(x, n.a), over_b = inverse(at(x, n.b));
    if (over_b.is_constant()) return {};
    if (a.is_constant()) return Symbol(1) / a * over_b;
    const Symbol over_a = inverse(a);
    return over_a.is_constant() ? Symbol() : over_a * over_b;
  }

  /// Returns sin(a + b) if `made` is sin and x + y = sin a cos b + cos a sin b, or cos(a + b) if `made` is cos and x −
  /// y = cos a cos b − sin a sin b, where a and b are linear in time; otherwise a constant. Sums of many harmonics then
  /// cost no products.
  static constexpr Symbol by_addition(const Symbol& x, const Symbol& y, Op made) {
    const Node u = node(x), v = node(y);
    if (u.op != Op::multiply || v.op != Op::multiply) return {};
    const Node f[] = {node(x, u.a), node(x, u.b)}, g[] = {node(x, v.a), node(x, v.b)};
    const bool sine = made == Op::sin;
    for (const int i : {0, 1})
      for (const int j : {0, 1}) {
        // sin a cos b + cos a sin b: f[i] = sin a, g[j] = cos a; cos a cos b − sin a sin b: f[i] = cos a, g[j] = sin a
        const Node &a = f[i], &b = f[1 - i], &c = g[j], &d = g[1 - j];
        const bool fits = sine ? a.op == Op::sin && b.op == Op::cos && c.op == Op::cos && d.op == Op::sin
                               : a.op == Op::cos && b.op == Op::cos && c.op == Op::sin && d.op == Op::sin;
        if (!fits || a.a != c.a || b.a != d.a || !node(x, a.a).linear || !node(x, b.a).linear) continue;
        const Symbol sum = at(x, a.a) + at(x, b.a);
        return sine ? sin(sum) : cos(sum);
      }
    return {};
  }

  // The operators as constant expressions.
  static constexpr Symbol add(const Symbol& a, const Symbol& b);
  static constexpr Symbol subtract(const Symbol& a, const Symbol& b);
  static constexpr Symbol multiply(const Symbol& a, const Symbol& b);
  static constexpr Symbol divide(const Symbol& a, const Symbol& b);
  static constexpr Symbol power_of(const Symbol& x, double exponent);
};

/// The operators at run time, compiled once here instead of inline in the source of every problem.
namespace recording {
Symbol add(const Symbol& a, const Symbol& b);
Symbol subtract(const Symbol& a, const Symbol& b);
Symbol multiply(const Symbol& a, const Symbol& b);
Symbol divide(const Symbol& a, const Symbol& b);
Symbol power_of(const Symbol& x, double exponent);
}  // namespace recording

constexpr Symbol operator+(const Symbol& a, const Symbol& b) {
  return std::is_constant_evaluated() ? Recorder::add(a, b) : recording::add(a, b);
}
constexpr Symbol operator-(const Symbol& a, const Symbol& b) {
  return std::is_constant_evaluated() ? Recorder::subtract(a, b) : recording::subtract(a, b);
}
constexpr Symbol operator*(const Symbol& a, const Symbol& b) {
  return std::is_constant_evaluated() ? Recorder::multiply(a, b) : recording::multiply(a, b);
}
constexpr Symbol operator/(const Symbol& a, const Symbol& b) {
  return std::is_constant_evaluated() ? Recorder::divide(a, b) : recording::divide(a, b);
}
constexpr Symbol pow(const Symbol& x, double exponent) {
  return std::is_constant_evaluated() ? Recorder::power_of(x, exponent) : recording::power_of(x, exponent);
}

constexpr Symbol Recorder::add(const Symbol& a, const Symbol& b) {
  if (a.is_constant() && b.is_constant())
    return Recorder::constant(a.constant() + b.constant(), a.constant_ + b.constant_);
  if (a.is_constant() && a.constant() == 0) return b;
  if (b.is_constant() && b.constant() == 0) return a;
  if (const Symbol less = Recorder::negated(b); !less.is_constant()) return a - less;
  if (const Symbol sine = Recorder::by_addition(a, b, tape::Op::sin); !sine.is_constant()) return sine;
  return Recorder::binary(tape::Op::add, a, b);
}

constexpr Symbol Recorder::subtract(const Symbol& a, const Symbol& b) {
  if (a.is_constant() && b.is_constant())
    return Recorder::constant(a.constant() - b.constant(), a.constant_ - b.constant_);
  if (a.is_constant() && a.constant() == 0) return -b;
  if (b.is_constant() && b.constant() == 0) return a;
  if (Recorder::same(a, b)) return 0;
  if (const Symbol more = Recorder::negated(b); !more.is_constant()) return a + more;
  if (const Symbol cosine = Recorder::by_addition(a, b, tape::Op::cos); !cosine.is_constant()) return cosine;
  return Recorder::binary(tape::Op::subtract, a, b);
}

constexpr Symbol Recorder::multiply(const Symbol& a, const Symbol& b) {
  if (a.is_constant() && b.is_constant())
    return Recorder::constant(a.constant() * b.constant(), a.constant_ * b.constant_);
  if (b.is_constant()) return b * a;
  const tape::Node right = Recorder::node(b);
  if (a.is_constant()) {
    if (a.constant() == 0) return 0;
    if (a.constant_ == DoubleDouble(1)) return b;
    if (right.op == tape::Op::multiply && Recorder::node(b, right.a).op == tape::Op::constant)  // of constants one
      return a * Recorder::at(b, right.a) * Recorder::at(b, right.b);
    return Recorder::binary(tape::Op::multiply, a, b);
  }
  const tape::Node left = Recorder::node(a);
  Symbol base;
  double p = 0;
  if (Recorder::is_power(b, base, p) && Recorder::same(a, base)) return pow(a, p + 1);  // u √u
  if (Recorder::is_power(a, base, p) && Recorder::same(b, base)) return pow(b, p + 1);
  // (c/u) x with u linear in time becomes c (x/u): the factor c costs nothing per order, and x/u may be finite at u =
  // 0.
  if (left.op == tape::Op::divide && Recorder::node(a, left.a).op == tape::Op::constant &&
      Recorder::node(a, left.b).linear)
    return Recorder::at(a, left.a) * (b / Recorder::at(a, left.b));
  if (right.op == tape::Op::divide && Recorder::node(b, right.a).op == tape::Op::constant &&
      Recorder::node(b, right.b).linear)
    return b * a;
  return Recorder::binary(tape::Op::multiply, a, b);
}

constexpr Symbol Recorder::divide(const Symbol& a, const Symbol& b) {
  if (a.is_constant() && b.is_constant())
    return Recorder::constant(a.constant() / b.constant(), a.constant_ / b.constant_);
  if (b.is_constant()) return a * (Symbol(1) / b);
  if (a.is_constant() && a.constant() == 0) return 0;
  if (Recorder::node(b).op == tape::Op::exp) return a * exp(-Recorder::at(b, Recorder::node(b).a));
  if (a.is_constant())
    if (const Symbol inverse = Recorder::inverse(b); !inverse.is_constant()) return a * inverse;
  Symbol base;
  double p = 0;
  if (Recorder::is_power(b, base, p) && (a.is_constant() || p != 0.5)) return a * pow(base, -p);
  return Recorder::binary(tape::Op::divide, a, b);
}

constexpr Symbol sqrt(const Symbol& x) {
  return x.is_constant() ? Recorder::function(tape::Op::sqrt, x, std::sqrt(x.constant()))
                         : Recorder::unary(tape::Op::sqrt, x);
}

constexpr Symbol Recorder::power_of(const Symbol& x, double exponent) {
  if (x.is_constant()) {
    const double plain = std::pow(x.constant(), exponent);
    return std::is_constant_evaluated() ? Symbol(plain) : Recorder::constant(plain, power(x.constant_, exponent));
  }
  if (exponent == 0.5) return sqrt(x);
  if (exponent < 0 && exponent >= -Symbol::most_factors && std::floor(0.5 * exponent) == 0.5 * exponent &&
      Recorder::node(x).op == tape::Op::cosh)
    return Symbol(1) / pow(x, -exponent);
  if (!(exponent >= 0 && exponent <= Symbol::most_factors && exponent == std::floor(exponent)))
    return Recorder::unary(tape::Op::power, x, exponent);
  Symbol result = 1, square = x;
  for (int n = static_cast<int>(exponent); n > 0; n /= 2) {
    if (n % 2) result = result * square;
    if (n > 1) square = square * square;
  }
  return result;
}
constexpr Symbol pow(const Symbol& x, const Symbol& exponent) {
  return exponent.is_constant() ? pow(x, exponent.constant()) : exp(exponent * log(x));
}

constexpr Symbol raise(const Symbol& x, const Symbol& exponent) {
  return exponent.is_constant() ? pow(x, exponent.constant()) : Recorder::binary(tape::Op::raise, x, exponent);
}

#define LEAST_RECORDS(f)                                                              \
  constexpr Symbol f(const Symbol& x) {                                               \
    return x.is_constant() ? Recorder::function(tape::Op::f, x, std::f(x.constant())) \
                           : Recorder::unary(tape::Op::f, x);                         \
  }
LEAST_RECORDS(exp)
LEAST_RECORDS(log)
LEAST_RECORDS(sin)
LEAST_RECORDS(cos)
LEAST_RECORDS(tan)
LEAST_RECORDS(sinh)
LEAST_RECORDS(cosh)
LEAST_RECORDS(tanh)
LEAST_RECORDS(atan)
LEAST_RECORDS(asin)
LEAST_RECORDS(acos)
#undef LEAST_RECORDS

constexpr Symbol::Mask operator<(const Symbol& a, const Symbol& b) { return {a - b}; }
constexpr Symbol::Mask operator>(const Symbol& a, const Symbol& b) { return {b - a}; }
constexpr Symbol::Mask operator<=(const Symbol& a, const Symbol& b) { return {b - a, true}; }
constexpr Symbol::Mask operator>=(const Symbol& a, const Symbol& b) { return {a - b, true}; }

constexpr Symbol select(const Symbol::Mask& mask, const Symbol& yes, const Symbol& no) {
  if (mask.negated) return select(!mask, no, yes);
  if (const Symbol& by = mask.difference; by.is_constant())
    return std::isnan(by.constant()) ? by : by.constant() < 0 ? yes : no;
  return Recorder::select(mask.difference, yes, no);
}
constexpr Symbol abs(const Symbol& x) { return select(x < Symbol(0), -x, x); }

}  // namespace least
