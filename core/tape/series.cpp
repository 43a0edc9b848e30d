#include "core/tape/series.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/tape/unrolled.hpp"

// Where the machine has wider registers, they are used: what is computed is the same.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define LEAST_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define LEAST_WIDE
#endif

namespace least::tape {

double value_of(Op function, double x) {
  switch (function) {
    case Op::exp:
      return std::exp(x);
    case Op::log:
      return std::log(x);
    case Op::sin:
      return std::sin(x);
    case Op::cos:
      return std::cos(x);
    case Op::tan:
      return std::tan(x);
    case Op::sinh:
      return std::sinh(x);
    case Op::cosh:
      return std::cosh(x);
    case Op::tanh:
      return std::tanh(x);
    case Op::atan:
      return std::atan(x);
    case Op::asin:
      return std::asin(x);
    default:
      return std::acos(x);
  }
}

namespace {

/// A program that is read.
struct Reader {
  static void begin(const Program& p, double* row) {
    const Rules<false> rules = rules_of(p);
    for (const Step& s : p.linear) rules.begin(s, s, row);
    for (const Step& s : p.steps) rules.begin(s, s, row);
  }

  LEAST_WIDE static void expand(const Program& p, const Workspace& of, Gain* gains, Ends* ends, std::size_t groups,
                                const Index* places, Four* slots, double* sums) {
    const Rules<false> rules = rules_of(p);
    const std::size_t stride = of.stride;
    if (of.begun != of.rows) std::copy_n(of.begun, stride, of.rows);
    for (std::size_t i = 0; i < p.steps.size(); ++i) gains[i] = Rules<false>::gain_of(p.steps[i], p.steps[i], of.rows);
    for (std::size_t i = 0; i < p.products.size(); ++i) ends[i] = ends_of(p.products[i], p.products[i].factor, of.rows);
    double* const second = of.rows + stride;
    for (std::size_t k = 0; k < of.orders; ++k) {
      double* const row = of.rows + k * stride;
      if (k > 0) {
        for (std::size_t g = 0; g < groups; ++g) {
          sum_slots<1>(of.lanes + g, groups, k, slots + g);
          if (k == 1) continue;
          const Four *low = of.lanes + 2 * groups + g, *high = of.lanes + (2 * k - 1) * groups + g;
          slots[g].lane += (low->lane * (k == 2 ? 0.5 : 1.0)) * high->lane;
        }
        for (std::size_t i = 0; i < p.slot.size(); ++i)
          sums[i] = sum_of(slots->begin() + p.slot[i], p.lane_a[i] == p.lane_b[i]);
        const double order = static_cast<double>(k), part = inverses[k];
        const double* const last = row - stride;
        if (k == 1)
          for (const Step& s : p.linear) rules.advance(s, s, order, part, second, last, row, sums, {}, ends);
        const Gain* gain = gains;
        for (const Step& s : p.steps) rules.advance(s, s, order, part, second, last, row, sums, *gain++, ends);
      }
      double* const next = row + stride;
      for (std::size_t i = 0; i < p.variables; ++i) {
        const double rate = row[p.rate[i]];
        next[at(Program::first_variable) + i] = rate * inverses[k + 1];
        next[p.weighted[i]] = rate;
      }
      double* const lanes = (of.lanes + k * 2 * groups)->begin();
      for (std::size_t i = 0; i < 8 * groups; ++i) lanes[i] = row[places[i]];
    }
  }

 private:
  static Rules<false> rules_of(const Program& p) {
    const Lists lists{p.values.data(), p.products.data()};
    return {lists, lists};
  }
};

const UnrolledSeries* unrolled_of(const Program& program) {
  for (const UnrolledSeries& known : unrolled_series())
    if (known.fits(program)) return &known;
  return nullptr;
}

}  // namespace

Series::Series(Program program, int order, bool unroll)
    : program_(std::move(program)),
      unrolled_(unroll ? unrolled_of(program_) : nullptr),
      order_(order),
      stride_(at(program_.rows)),
      groups_(program_.low.size() / 4),
      rows_((static_cast<std::size_t>(order) + 1) * stride_ + 4),
      trial_(stride_),
      lanes_(2 * groups_ * (static_cast<std::size_t>(order) + 1)) {
  trial_[at(program_.time())] = std::numeric_limits<double>::quiet_NaN();  // of no state yet
  if (unrolled_) return;
  gains_.resize(program_.steps.size());
  ends_.resize(program_.products.size());
  slots_.resize(groups_ + 1);
  sums_.resize(program_.lane_a.size());
  places_ = program_.low;
  places_.insert(places_.end(), program_.high.begin(), program_.high.end());
}

void Series::expand(const double* x, double t) {
  double* const row = rows_.data();
  const bool begun = t == trial_[at(program_.time())] &&
                     std::equal(x, x + program_.variables, trial_.data() + Program::first_variable);
  std::copy_n(x, program_.variables, row + Program::first_variable);
  row[program_.time()] = t;
  if (!begun) begin(row);
  const Workspace of{static_cast<std::size_t>(order_), stride_, begun ? trial_.data() : row, row, lanes_.data()};
  if (unrolled_) return unrolled_->expand(program_, of);
  row[stride_ + at(program_.time())] = 1;
  row[stride_ + at(program_.weighted.back())] = 1;
  Reader::expand(program_, of, gains_.data(), ends_.data(), groups_, places_.data(), slots_.data(), sums_.data());
}

void Series::begin(double* row) const {
  if (unrolled_) {
    unrolled_->begin(program_, row);
  } else {
    Reader::begin(program_, row);
  }
}

bool Series::defined(const double* x, double t) {
  std::copy_n(x, program_.variables, trial_.data() + Program::first_variable);
  trial_[at(program_.time())] = t;
  begin(trial_.data());
  for (std::size_t i = 0; i < program_.moving; ++i)
    if (!std::isfinite(trial_[at(program_.rate[i])])) return false;
  return true;
}

}  // namespace least::tape
