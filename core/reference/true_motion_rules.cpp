// The recurrences of TrueMotion: how an operation computes the orders of its node.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/reference/true_motion.hpp"
#include "core/tape/wide.hpp"

namespace least {
namespace {

using tape::Index;
using tape::Node;
using tape::Op;

std::size_t place_of(Index i) { return static_cast<std::size_t>(i); }

DoubleDouble halved(const DoubleDouble& x) { return {0.5 * x.high(), 0.5 * x.low()}; }

}  // namespace

/// Computes order 0 of node i.
void TrueMotion::begin(Index i) {
  const Node& node = tape_[i];
  DoubleDouble* const out = row(i);
  const DoubleDouble* const a = node.a == tape::none ? nullptr : row(node.a);
  const DoubleDouble* const b = node.b == tape::none ? nullptr : row(node.b);
  const Index helper = rows_of_[place_of(i)].helper;
  switch (node.op) {
    case Op::constant:
    case Op::variable:
      return;
    case Op::time:
      out[0] = t_;
      out[1] = unit_;
      return;
    case Op::add:
      out[0] = a[0] + b[0];
      return;
    case Op::subtract:
      out[0] = a[0] - b[0];
      return;
    case Op::multiply:
      out[0] = a[0] * b[0];
      return;
    case Op::divide:
      out[0] = a[0] / b[0];
      break;
    case Op::power:
      out[0] = power(a[0], node.value);
      break;
    case Op::select: {
      Choice& choice = choices_[choice_of_[place_of(i)]];
      if (chooses_) choice.first = a[0].high() < 0;
      out[0] = choice.first ? b[0] : row(node.c)[0];
      return;
    }
    default:
      out[0] = elementary(node.op, a[0]);
      if (!(std::abs(out[0].high()) <= bound_) && tape::steepness(node.op))
        out[0] = std::copysign(bound_, out[0].high());
  }
  if (node.op == Op::tan) row(helper)[0] = DoubleDouble(1) + out[0] * out[0];
  if (node.op == Op::tanh) {  // 1 − tanh² would lose all its digits, and cosh may overflow
    const DoubleDouble decay = elementary(Op::exp, a[0].high() > 0 ? -a[0] : a[0]);
    const DoubleDouble sech = 2.0 * decay / (DoubleDouble(1) + decay * decay);
    row(helper)[0] = sech * sech;
  }
  if (node.op == Op::atan) row(helper)[0] = DoubleDouble(1) + a[0] * a[0];
  if (node.op == Op::asin || node.op == Op::acos) {
    row(helper + 1)[0] = DoubleDouble(1) - a[0] * a[0];
    row(helper)[0] = elementary(Op::sqrt, row(helper + 1)[0]);
  }
  if (const DoubleDouble* const below = divisor_of(i)) reciprocals_[place_of(i)] = DoubleDouble(1) / *below;
}

/// Computes order 0 of all nodes; steep functions are clamped to ±bound.
LEAST_FUSED void TrueMotion::begin_all(double bound) {
  bound_ = bound;
  for (Index i = 0; i < tape_.size(); ++i) begin(i);
}

bool TrueMotion::finite_rates() const {
  return std::ranges::all_of(rates_, [this](Index rate) { return std::isfinite(row(rate)[0].high()); });
}

/// Computes order 0 of all nodes at x. A steep function that overflows may stand in a divisor, such as cosh² in v/cosh²
/// u. Where rates are not finite, or if `bounded`, such functions are clamped to a bound, but only if a higher bound
/// gives the same rates.
void TrueMotion::begin_at(const std::vector<DoubleDouble>& x, bool bounded) {
  constexpr double bound = 1e50, higher = 1e60, same = 1e-30;
  for (std::size_t v = 0; v < variables_.size(); ++v) row(variables_[v])[0] = x[v];
  if (!bounded) {
    begin_all(std::numeric_limits<double>::infinity());
    if (steep_.empty() || finite_rates()) return;
  }
  begin_all(higher);
  std::vector<DoubleDouble> rates;
  for (const Index rate : rates_) rates.push_back(row(rate)[0]);
  begin_all(bound);
  for (std::size_t v = 0; v < rates.size(); ++v) {
    const DoubleDouble rate = row(rates_[v])[0];
    if (!(std::abs((rate - rates[v]).high()) <= same * (1 + std::abs(rate.high()))))
      return begin_all(std::numeric_limits<double>::infinity());
  }
}

/// Returns the row whose order 0 divides every order of the node, or null.
const DoubleDouble* TrueMotion::divisor_of(Index i) const {
  switch (tape_[i].op) {
    case Op::divide:
      return row(tape_[i].b);
    case Op::power:
    case Op::log:
      return row(tape_[i].a);
    case Op::sqrt:
      return row(i);
    case Op::atan:
    case Op::asin:
    case Op::acos:
      return row(rows_of_[place_of(i)].helper);
    default:
      return nullptr;
  }
}

/// Computes order k > 0 of node i from the orders up to k of its operands.
LEAST_FUSED void TrueMotion::extend(Index i, std::size_t k) {
  const Node& node = tape_[i];
  const Rows& own = rows_of_[place_of(i)];
  DoubleDouble* const out = row(i);
  const DoubleDouble* const a = node.a == tape::none ? nullptr : row(node.a);
  const DoubleDouble* const b = node.b == tape::none ? nullptr : row(node.b);
  const auto constant = [&](Index operand) { return tape_[operand].op == Op::constant; };
  const auto slope_of = [&](Index operand) -> const DoubleDouble* { return row(rows_of_[place_of(operand)].weighted); };
  const DoubleDouble inverse = inverses_[k], reciprocal = reciprocals_[place_of(i)];
  // Σ w_j ȯut_{k−j} over 0 < j < k, where ȯut = ȧ/w.
  const auto log_like = [&](const DoubleDouble* w, const DoubleDouble& change) {
    out[k] = (change - inverse * convolve(w, row(own.weighted), k, 1, k - 1)) * reciprocal;
  };
  switch (node.op) {
    case Op::add:
      out[k] = a[k] + b[k];
      break;
    case Op::subtract:
      out[k] = a[k] - b[k];
      break;
    case Op::multiply:
      out[k] = constant(node.a)   ? a[0] * b[k]
               : constant(node.b) ? a[k] * b[0]
               : a == b           ? square(a, k, 0)
                                  : convolve(a, b, k, 0, k);
      break;
    case Op::divide:
      out[k] = (a[k] - convolve(b, out, k, 1, k)) * reciprocal;
      break;
    case Op::power:
      out[k] = (node.value * convolve(slope_of(node.a), out, k, 1, k) - convolve(a, row(own.weighted), k, 1, k - 1)) *
               inverse * reciprocal;
      break;
    case Op::sqrt:
      out[k] = halved((a[k] - (k > 1 ? square(out, k, 1) : DoubleDouble())) * reciprocal);
      break;
    case Op::exp:
      out[k] = inverse * convolve(slope_of(node.a), out, k, 1, k);
      break;
    case Op::sin:
    case Op::sinh:
    case Op::cosh:
      out[k] = inverse * convolve(slope_of(node.a), row(own.helper), k, 1, k);
      break;
    case Op::cos:
      out[k] = -(inverse * convolve(slope_of(node.a), row(own.helper), k, 1, k));
      break;
    case Op::tan:
    case Op::tanh: {
      DoubleDouble* const w = row(own.helper);
      out[k] = inverse * convolve(slope_of(node.a), w, k, 1, k);
      w[k] = node.op == Op::tan ? square(out, k, 0) : -square(out, k, 0);
      break;
    }
    case Op::log:
      log_like(a, a[k]);
      break;
    case Op::atan:
      row(own.helper)[k] = square(a, k, 0);
      log_like(row(own.helper), a[k]);
      break;
    case Op::asin:
    case Op::acos: {
      DoubleDouble *const w = row(own.helper), *const u = row(own.helper + 1);
      u[k] = -square(a, k, 0);
      w[k] = halved((u[k] - (k > 1 ? square(w, k, 1) : DoubleDouble())) * reciprocal);
      log_like(w, node.op == Op::asin ? a[k] : -a[k]);
      break;
    }
    case Op::select:
      out[k] = choices_[choice_of_[place_of(i)]].first ? b[k] : row(node.c)[k];
      break;
    default:
      return;
  }
  if (own.weighted != tape::none) row(own.weighted)[k] = static_cast<double>(k) * out[k];
}

}  // namespace least
