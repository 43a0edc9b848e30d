// A toy recording symbol: arithmetic writes a tape, at compile time. It has no value, so nothing can branch on it; it
// is the place where a Taylor scheme will enter.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <utility>

namespace toy {

enum class Op {
  constant,
  variable,
  negate,
  add,
  subtract,
  multiply,
  divide,
  sine,
  cosine,
  exponential,
  logarithm,
  root,
  tangent_h,
  power,
  less,
  choose,  ///< a: mask; constant: the line of the other choice, b: of the first
};

struct Tape {
  struct Line {
    Op op{};
    int a = -1, b = -1;
    double constant = 0;
  };
  std::array<Line, 400> lines{};
  int size = 0;
  constexpr int write(Line line) {
    lines.at(static_cast<std::size_t>(size)) = line;  // a longer tape does not compile
    return size++;
  }
  /// Value of a line when the variables have these values, by replaying the tape.
  template <std::size_t N>
  double replay(int line, const std::array<double, N>& variables) const {
    std::array<double, 400> value{};
    for (int i = 0; i <= line; ++i) {
      const Line& l = lines[static_cast<std::size_t>(i)];
      const double a = l.a >= 0 ? value[static_cast<std::size_t>(l.a)] : 0;
      const double b = l.b >= 0 ? value[static_cast<std::size_t>(l.b)] : 0;
      double& v = value[static_cast<std::size_t>(i)];
      switch (l.op) {
        case Op::constant:
          v = l.constant;
          break;
        case Op::variable:
          v = variables[static_cast<std::size_t>(l.constant)];
          break;
        case Op::negate:
          v = -a;
          break;
        case Op::add:
          v = a + b;
          break;
        case Op::subtract:
          v = a - b;
          break;
        case Op::multiply:
          v = a * b;
          break;
        case Op::divide:
          v = a / b;
          break;
        case Op::sine:
          v = std::sin(a);
          break;
        case Op::cosine:
          v = std::cos(a);
          break;
        case Op::exponential:
          v = std::exp(a);
          break;
        case Op::logarithm:
          v = std::log(a);
          break;
        case Op::root:
          v = std::sqrt(a);
          break;
        case Op::tangent_h:
          v = std::tanh(a);
          break;
        case Op::power:
          v = std::pow(a, l.constant);
          break;
        case Op::less:
          v = a < b;
          break;
        case Op::choose:
          v = a != 0 ? b : value[static_cast<std::size_t>(l.constant)];
          break;
      }
    }
    return value[static_cast<std::size_t>(line)];
  }
};

struct Symbol {
  Tape* tape = nullptr;  ///< none: a constant that no variable has touched
  int line = -1;
  double constant = 0;

  constexpr Symbol() = default;
  constexpr Symbol(double x) : constant(x) {}
  constexpr Symbol(Tape& t, int variable) : tape(&t), line(t.write({Op::variable, -1, -1, double(variable)})) {}

  constexpr int on(Tape& t) const { return tape ? line : t.write({Op::constant, -1, -1, constant}); }
};

constexpr Symbol record(Op op, const Symbol& a) {
  Symbol r;
  r.tape = a.tape;  // of a constant: writes through a null pointer, which does not compile
  r.line = r.tape->write({op, a.line, -1, 0});
  return r;
}
constexpr Symbol record(Op op, const Symbol& a, const Symbol& b) {
  Symbol r;
  r.tape = a.tape ? a.tape : b.tape;
  if (!r.tape) {
    r.constant = op == Op::add        ? a.constant + b.constant
                 : op == Op::subtract ? a.constant - b.constant
                 : op == Op::multiply ? a.constant * b.constant
                                      : a.constant / b.constant;
    return r;
  }
  const int left = a.on(*r.tape), right = b.on(*r.tape);
  r.line = r.tape->write({op, left, right, 0});
  return r;
}

constexpr Symbol operator-(const Symbol& a) { return a.tape ? record(Op::negate, a) : Symbol(-a.constant); }
constexpr Symbol operator+(const Symbol& a, const Symbol& b) { return record(Op::add, a, b); }
constexpr Symbol operator-(const Symbol& a, const Symbol& b) { return record(Op::subtract, a, b); }
constexpr Symbol operator*(const Symbol& a, const Symbol& b) { return record(Op::multiply, a, b); }
constexpr Symbol operator/(const Symbol& a, const Symbol& b) { return record(Op::divide, a, b); }
constexpr Symbol sin(const Symbol& a) { return record(Op::sine, a); }
constexpr Symbol cos(const Symbol& a) { return record(Op::cosine, a); }
constexpr std::pair<Symbol, Symbol> sincos(const Symbol& a) { return {sin(a), cos(a)}; }
constexpr Symbol exp(const Symbol& a) { return record(Op::exponential, a); }
constexpr Symbol log(const Symbol& a) { return record(Op::logarithm, a); }
constexpr Symbol sqrt(const Symbol& a) { return record(Op::root, a); }
constexpr Symbol tanh(const Symbol& a) { return record(Op::tangent_h, a); }
constexpr Symbol pow(const Symbol& a, double y) {
  Symbol r = a;
  r.line = a.tape->write({Op::power, a.line, -1, y});
  return r;
}
/// A comparison is recorded, not decided.
struct Recorded {
  Symbol bit;
};
constexpr Recorded operator<(const Symbol& a, const Symbol& b) { return {record(Op::less, a, b)}; }
constexpr Symbol select(const Recorded& mask, const Symbol& yes, const Symbol& no) {
  Symbol r = mask.bit;
  const int first = yes.on(*r.tape), second = no.on(*r.tape);
  r.line = r.tape->write({Op::choose, mask.bit.line, first, double(second)});
  return r;
}
/// Mechanics that branch on what moves do not compile.
static_assert(!std::is_constructible_v<bool, Recorded> && !std::is_constructible_v<bool, Symbol> &&
              !std::is_constructible_v<double, Symbol>);
constexpr Symbol abs(const Symbol& a) { return select(a < Symbol(0.0), -a, a); }

}  // namespace toy
