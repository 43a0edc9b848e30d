#include "core/tape/series.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/tape/steep.hpp"
#include "core/tape/unrolled.hpp"
#include "core/tape/wide.hpp"

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
  static void begin(const Program& p, double* row, bool bounded = false) {
    constexpr double bound = 1e50;
    const Rules<false> rules = rules_of(p);
    for (const Step& s : p.linear) rules.begin(s, s, row);
    for (const Step& s : p.steps) {
      rules.begin(s, s, row);
      if (bounded && steepness(s.function)) row[s.out] = std::clamp(row[s.out], -bound, bound);
    }
  }

  LEAST_WIDE static void expand(const Program& p, const Workspace& of, Series::Reading& by, bool bounded) {
    const Rules<false> rules = rules_of(p);
    const std::size_t stride = of.stride, groups = p.low.size() / 4;
    if (of.begun) {
      std::copy_n(of.begun, stride, of.rows);
    } else {
      std::copy_n(of.x, p.variables, of.rows + Program::first_variable);
      of.rows[p.time()] = of.t;
      begin(p, of.rows, bounded);
    }
    for (std::size_t i = 0; i < p.steps.size(); ++i)
      by.gains[i] = Rules<false>::gain_of(p.steps[i], p.steps[i], of.rows);
    for (std::size_t i = 0; i < p.products.size(); ++i)
      by.ends[i] = ends_of(p.products[i], p.products[i].factor, of.rows);
    double* const second = of.rows + stride;
    for (std::size_t k = 0; k < of.orders; ++k) {
      double* const row = of.rows + k * stride;
      if (k > 0) {
        const double* const last = row - stride;
        const double share = k == 2 ? 0.5 : 1;
        if (k <= 3)
          for (std::size_t i = 0; i < stride; ++i) by.half[i] = k == 1 ? 0 : share * second[i];
        for (std::size_t g = 0; g < groups; ++g) {
          sum_slots(of.lanes + g, groups, k, by.older_slots[g]);
          by.slots[g] = by.older_slots[g];
          if (k == 1) continue;
          const Four *low = of.lanes + 2 * groups + g, *high = of.lanes + (2 * k - 1) * groups + g;
          by.slots[g].lane += (low->lane * share) * high->lane;
        }
        for (std::size_t i = 0; i < p.slot.size(); ++i) {
          const bool square = p.lane_a[i] == p.lane_b[i];
          by.older[i] = sum_of(by.older_slots.front().begin() + p.slot[i], square);
          by.sums[i] = sum_of(by.slots.front().begin() + p.slot[i], square);
        }
        const Known known{static_cast<double>(k), inverses[k],    second,        by.half.data(), last,
                          by.older.data(),        by.sums.data(), by.ends.data()};
        if (k == 1)
          for (const Step& s : p.linear) rules.advance(s, s, known, {}, row);
        const StepFactors* gain = by.gains.data();
        for (const Step& s : p.steps) rules.advance(s, s, known, *gain++, row);
      }
      double* const next = row + stride;
      for (std::size_t i = 0; i < p.variables; ++i) {
        const double rate = row[p.rate[i]];
        next[at(Program::first_variable) + i] = rate * inverses[k + 1];
        next[p.weighted[i]] = rate;
      }
      double* const lanes = (of.lanes + k * 2 * groups)->begin();
      for (std::size_t i = 0; i < 8 * groups; ++i) lanes[i] = row[by.places[i]];
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
  reading_.gains.resize(program_.steps.size());
  reading_.ends.resize(program_.products.size());
  reading_.half.resize(stride_);
  for (auto* slots : {&reading_.older_slots, &reading_.slots}) slots->resize(groups_ + 1);
  for (auto* sums : {&reading_.older, &reading_.sums}) sums->resize(program_.lane_a.size());
  reading_.places = program_.low;
  reading_.places.insert(reading_.places.end(), program_.high.begin(), program_.high.end());
}

void Series::expand(const double* x, double t, bool bounded) {
  double* const row = rows_.data();
  const bool begun = !bounded && t == trial_[at(program_.time())] &&
                     std::equal(x, x + program_.variables, trial_.data() + Program::first_variable);
  const Workspace of{
      static_cast<std::size_t>(order_), stride_, x, t, begun ? trial_.data() : nullptr, row, lanes_.data()};
  if (unrolled_) return unrolled_->expand(program_, of);
  row[stride_ + at(program_.time())] = 1;
  row[stride_ + at(program_.weighted.back())] = 1;
  Reader::expand(program_, of, reading_, bounded);
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
