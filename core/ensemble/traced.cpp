#include "core/ensemble/traced.hpp"

#include <sleef.h>

#include <cmath>

namespace least {

Trace::Trace() : nodes_{{Kind::time}, {Kind::step}} {}

void Trace::make_room() {
  nodes_.reserve(most_nodes);
  constants_.reserve(most_nodes);
}
void Trace::close() {
  nodes_.shrink_to_fit();
  constants_.shrink_to_fit();
}

Trace::Place Trace::write(const Node& node) {
  if (full()) return 0;
  nodes_.push_back(node);
  return size() - 1;
}
Trace::Place Trace::constant(double value) {
  if (full()) return 0;
  constants_.push_back(value);
  return write({Kind::constant, {}, static_cast<Place>(constants_.size()) - 1});
}

Traced Traced::made(LaneCode code, const Traced& a) {
  return {*a.trace_, a.trace_->write({Trace::Kind::operation, code, a.place_})};
}
Traced Traced::made(LaneCode code, const Traced& a, const Traced& b) {
  Trace& trace = a.trace_ ? *a.trace_ : *b.trace_;
  const Trace::Place of[] = {a.on(trace), b.on(trace)};
  return {trace, trace.write({Trace::Kind::operation, code, of[0], of[1]})};
}
Traced Traced::made(LaneCode code, const Traced& a, const Traced& b, const Traced& c) {
  Trace& trace = *a.trace_;
  const Trace::Place of[] = {a.on(trace), b.on(trace), c.on(trace)};
  return {trace, trace.write({Trace::Kind::operation, code, of[0], of[1], of[2]})};
}

namespace {
bool is_number(const Traced& x, double value) { return x.is_constant() && x.constant() == value; }
}  // namespace

Traced operator+(const Traced& a, const Traced& b) {
  if (a.is_constant() && b.is_constant()) return a.constant_ + b.constant_;
  if (is_number(a, 0)) return b;
  if (is_number(b, 0)) return a;
  return Traced::made(LaneCode::add, a, b);
}
Traced operator-(const Traced& a, const Traced& b) {
  if (a.is_constant() && b.is_constant()) return a.constant_ - b.constant_;
  if (is_number(b, 0)) return a;
  return Traced::made(LaneCode::subtract, a, b);
}
Traced operator*(const Traced& a, const Traced& b) {
  if (a.is_constant() && b.is_constant()) return a.constant_ * b.constant_;
  if (is_number(a, 0) || is_number(b, 0)) return 0;
  if (is_number(a, 1)) return b;
  if (is_number(b, 1)) return a;
  return Traced::made(LaneCode::multiply, a, b);
}
Traced operator/(const Traced& a, const Traced& b) {
  if (a.is_constant() && b.is_constant()) return a.constant_ / b.constant_;
  if (is_number(a, 0)) return 0;
  if (is_number(b, 1)) return a;
  return Traced::made(LaneCode::divide, a, b);
}
/// scaled keeps 0 · x, which a select adds to its result so that it is NaN where its condition is
/// (core/tape/symbol.hpp).
Traced scaled(const Traced& x, double factor) {
  return factor == 0 && !x.is_constant() ? Traced::made(LaneCode::multiply, x, factor) : x * factor;
}

// Constants are folded by the same functions as lanes use.
Traced sqrt(const Traced& x) {
  return x.is_constant() ? Traced(std::sqrt(x.constant_)) : Traced::made(LaneCode::sqrt, x);
}
Traced abs(const Traced& x) {
  return x.is_constant() ? Traced(std::fabs(x.constant_)) : Traced::made(LaneCode::abs, x);
}
#define LEAST_TRACED(name, ulp)                                                      \
  Traced name(const Traced& x) {                                                     \
    return x.is_constant() ? Traced(Sleef_cinz_##name##d1_##ulp##purec(x.constant_)) \
                           : Traced::made(LaneCode::name, x);                        \
  }
LEAST_TRACED(exp, u10)
LEAST_TRACED(expm1, u10)
LEAST_TRACED(log, u10)
LEAST_TRACED(sin, u35)
LEAST_TRACED(cos, u35)
LEAST_TRACED(tan, u10)
LEAST_TRACED(sinh, u10)
LEAST_TRACED(cosh, u10)
LEAST_TRACED(tanh, u10)
LEAST_TRACED(atan, u10)
LEAST_TRACED(asin, u10)
LEAST_TRACED(acos, u10)
#undef LEAST_TRACED
Traced pow(const Traced& x, double exponent) {
  if (x.is_constant()) return Sleef_cinz_powd1_u10purec(x.constant_, exponent);
  return Traced::made(LaneCode::raise, x, exponent);
}
Traced raise(const Traced& x, const Traced& exponent) {
  return exponent.is_constant() ? pow(x, exponent.constant_) : Traced::made(LaneCode::raise, x, exponent);
}
Traced phi1(const Traced& z) {
  const Traced::Mask some = abs(z) > Traced(0);
  return select(some, expm1(z) / select(some, z, Traced(1)), Traced(1));
}

Traced::Mask operator<(const Traced& a, const Traced& b) {
  if (a.is_constant() && b.is_constant()) return {a.constant_ < b.constant_ ? 1 : 0};
  return {Traced::made(LaneCode::less, a, b)};
}
Traced::Mask operator<=(const Traced& a, const Traced& b) {
  if (a.is_constant() && b.is_constant()) return {a.constant_ <= b.constant_ ? 1 : 0};
  return {Traced::made(LaneCode::not_greater, a, b)};
}
Traced::Mask operator>(const Traced& a, const Traced& b) { return b < a; }
Traced::Mask operator>=(const Traced& a, const Traced& b) { return b <= a; }
Traced select(const Traced::Mask& mask, const Traced& yes, const Traced& no) {
  if (mask.on.is_constant()) return mask.on.constant_ != 0 ? yes : no;
  if (yes.is_constant() && no.is_constant() && yes.constant_ == 1 && no.constant_ == 0) return mask.on;
  return Traced::made(LaneCode::select, mask.on, yes, no);
}

}  // namespace least
