#include "core/tape/symbol.hpp"

#include <cmath>

namespace least {

using tape::Index;
using tape::Node;
using tape::Op;

/// What operations look at before they write.
struct Recorder {
  static Symbol unary(Op op, const Symbol& x, double value = 0) {
    return {*x.tape_, x.tape_->write({.op = op, .a = x.node_, .value = value})};
  }
  static Symbol binary(Op op, const Symbol& a, const Symbol& b) {
    tape::Tape& tape = a.tape_ ? *a.tape_ : *b.tape_;
    const Index left = a.on(tape), right = b.on(tape);
    return {tape, tape.write({.op = op, .a = left, .b = right})};
  }
  static Symbol select(const Symbol& difference, const Symbol& yes, const Symbol& no) {
    tape::Tape& tape = *difference.tape_;
    const Index first = yes.on(tape), second = no.on(tape);
    return {tape, tape.write({.op = Op::select, .a = difference.node_, .b = first, .c = second})};
  }
  /// The node of x, or of a constant one that says nothing.
  static Node node(const Symbol& x) { return x.tape_ ? (*x.tape_)[x.node_] : Node{}; }
  static Node node(const Symbol& of, Index i) { return (*of.tape_)[i]; }
  static Symbol at(const Symbol& of, Index i) { return Symbol::at(*of.tape_, i); }
  /// A constant to all its digits; as doubles have it where those of more digits over- or underflow.
  static Symbol constant(double plain, const DoubleDouble& exact) {
    return Symbol(std::isfinite(exact.high() + exact.low()) ? exact : DoubleDouble(plain));
  }
  static bool same(const Symbol& a, const Symbol& b) { return a.tape_ && a.tape_ == b.tape_ && a.node_ == b.node_; }

  /// x is uᵖ of no whole p, or √u: both.
  static bool is_power(const Symbol& x, Symbol& base, double& exponent) {
    const Node n = node(x);
    if (n.op != Op::power && n.op != Op::sqrt) return false;
    base = at(x, n.a);
    exponent = n.op == Op::sqrt ? 0.5 : n.value;
    return true;
  }

  /// sin(a + b) where x + y is sin a cos b + cos a sin b, cos(a + b) where x − y is cos a cos b − sin a sin b, of
  /// angles linear in time: sums of many harmonics cost no products. A constant otherwise.
  static Symbol by_addition(const Symbol& x, const Symbol& y, Op made) {
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
};

Symbol operator+(const Symbol& a, const Symbol& b) {
  if (a.is_constant() && b.is_constant())
    return Recorder::constant(a.constant() + b.constant(), a.constant_ + b.constant_);
  if (a.is_constant() && a.constant() == 0) return b;
  if (b.is_constant() && b.constant() == 0) return a;
  if (const Symbol sine = Recorder::by_addition(a, b, Op::sin); !sine.is_constant()) return sine;
  return Recorder::binary(Op::add, a, b);
}

Symbol operator-(const Symbol& a, const Symbol& b) {
  if (a.is_constant() && b.is_constant())
    return Recorder::constant(a.constant() - b.constant(), a.constant_ - b.constant_);
  if (a.is_constant() && a.constant() == 0) return -b;
  if (b.is_constant() && b.constant() == 0) return a;
  if (Recorder::same(a, b)) return 0;
  if (const Symbol cosine = Recorder::by_addition(a, b, Op::cos); !cosine.is_constant()) return cosine;
  return Recorder::binary(Op::subtract, a, b);
}

Symbol operator*(const Symbol& a, const Symbol& b) {
  if (a.is_constant() && b.is_constant())
    return Recorder::constant(a.constant() * b.constant(), a.constant_ * b.constant_);
  if (b.is_constant()) return b * a;
  const Node right = Recorder::node(b);
  if (a.is_constant()) {
    if (a.constant() == 0) return 0;
    if (a.constant_ == DoubleDouble(1)) return b;
    if (right.op == Op::multiply && Recorder::node(b, right.a).op == Op::constant)  // of constants one
      return a * Recorder::at(b, right.a) * Recorder::at(b, right.b);
    return Recorder::binary(Op::multiply, a, b);
  }
  const Node left = Recorder::node(a);
  Symbol base;
  double p = 0;
  if (Recorder::is_power(b, base, p) && Recorder::same(a, base)) return pow(a, p + 1);  // u √u
  if (Recorder::is_power(a, base, p) && Recorder::same(b, base)) return pow(b, p + 1);
  // (c/u) x with u linear in time: c (x/u) costs nothing per order, and goes on to where u = 0 and x/u is finite.
  if (left.op == Op::divide && Recorder::node(a, left.a).op == Op::constant && Recorder::node(a, left.b).linear)
    return Recorder::at(a, left.a) * (b / Recorder::at(a, left.b));
  if (right.op == Op::divide && Recorder::node(b, right.a).op == Op::constant && Recorder::node(b, right.b).linear)
    return b * a;
  return Recorder::binary(Op::multiply, a, b);
}

Symbol operator/(const Symbol& a, const Symbol& b) {
  if (a.is_constant() && b.is_constant())
    return Recorder::constant(a.constant() / b.constant(), a.constant_ / b.constant_);
  if (b.is_constant()) return a * (Symbol(1) / b);
  if (a.is_constant() && a.constant() == 0) return 0;
  Symbol base;
  double p = 0;
  if (Recorder::is_power(b, base, p) && (a.is_constant() || p != 0.5)) return a * pow(base, -p);
  return Recorder::binary(Op::divide, a, b);
}

Symbol sqrt(const Symbol& x) {
  return x.is_constant() ? Recorder::constant(std::sqrt(x.constant()), elementary(Op::sqrt, x.constant_))
                         : Recorder::unary(Op::sqrt, x);
}

Symbol pow(const Symbol& x, double exponent) {
  if (x.is_constant()) return Recorder::constant(std::pow(x.constant(), exponent), power(x.constant_, exponent));
  if (exponent == 0.5) return sqrt(x);
  if (!(exponent >= 0 && exponent <= Symbol::most_factors && exponent == std::floor(exponent)))
    return Recorder::unary(Op::power, x, exponent);
  Symbol result = 1, square = x;
  for (int n = static_cast<int>(exponent); n > 0; n /= 2) {
    if (n % 2) result = result * square;
    if (n > 1) square = square * square;
  }
  return result;
}
Symbol pow(const Symbol& x, const Symbol& exponent) {
  return exponent.is_constant() ? pow(x, exponent.constant()) : exp(exponent * log(x));
}

Symbol raise(const Symbol& x, const Symbol& exponent) {
  return exponent.is_constant() ? pow(x, exponent.constant()) : Recorder::binary(Op::raise, x, exponent);
}

#define LEAST_RECORDS(f)                                                                              \
  Symbol f(const Symbol& x) {                                                                         \
    return x.is_constant() ? Recorder::constant(std::f(x.constant()), elementary(Op::f, x.constant_)) \
                           : Recorder::unary(Op::f, x);                                               \
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

Symbol::Mask operator<(const Symbol& a, const Symbol& b) { return {a - b}; }
Symbol::Mask operator>(const Symbol& a, const Symbol& b) { return {b - a}; }
Symbol::Mask operator<=(const Symbol& a, const Symbol& b) { return {b - a, true}; }
Symbol::Mask operator>=(const Symbol& a, const Symbol& b) { return {a - b, true}; }

Symbol select(const Symbol::Mask& mask, const Symbol& yes, const Symbol& no) {
  if (mask.negated) return select(!mask, no, yes);
  if (mask.difference.is_constant()) return mask.difference.constant() < 0 ? yes : no;
  return Recorder::select(mask.difference, yes, no);
}
Symbol abs(const Symbol& x) { return select(x < Symbol(0), -x, x); }

}  // namespace least
