#include "core/tape/series.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/tape/closer_series.hpp"
#include "core/tape/series_reading.hpp"
#include "core/tape/unrolled.hpp"

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

const UnrolledSeries* unrolled_of(const Program& program) {
  for (const UnrolledSeries& known : unrolled_series())
    if (known.fits(program)) return &known;
  return nullptr;
}

}  // namespace

Series::Series(Program program, int order, bool unroll)
    : program_(std::move(program)),
      unrolled_(unroll ? unrolled_of(program_) : nullptr),
      reading_(unrolled_ ? nullptr : std::make_unique<SeriesReading>(program_)),
      closer_(reading_ ? CloserSeries::of(program_, order) : nullptr),
      order_(order),
      stride_(unrolled_ ? at(program_.rows) : reading_->stride()),
      rows_(((static_cast<std::size_t>(order) + 1) * stride_ + 4) / 8 + 1),
      trial_(stride_),
      lanes_(unrolled_ ? program_.low.size() / 2 * (static_cast<std::size_t>(order) + 1) : 0) {
  trial_[at(program_.time())] = std::numeric_limits<double>::quiet_NaN();  // no state was asked for yet
}
Series::Series(Series&& other) noexcept = default;
Series::~Series() = default;

std::size_t Series::bytes() const {
  return sizeof(Line) * rows_.size() + sizeof(Four) * lanes_.size() + sizeof(double) * trial_.size() +
         sizeof(Step) * program_.steps.size() + sizeof(Program::Value) * program_.values.size() +
         sizeof(Program::Product) * program_.products.size() + (reading_ ? reading_->bytes() : 0) +
         (closer_ ? closer_->bytes() : 0);
}

void Series::expand(const double* x, double t, bool bounded) {
  double* const row = rows();
  const bool begun = !bounded && t == trial_[at(program_.time())] &&
                     std::equal(x, x + program_.variables, trial_.data() + Program::first_variable);
  const Workspace of{
      static_cast<std::size_t>(order_), stride_, x, t, begun ? trial_.data() : nullptr, row, lanes_.data()};
  if (unrolled_) return unrolled_->expand(program_, of);
  if (begun) {
    std::copy(trial_.begin(), trial_.end(), row);
  } else {
    std::copy_n(x, program_.variables, row + Program::first_variable);
    row[program_.time()] = t;
    begin(row, bounded);
  }
  row[stride_ + at(program_.time())] = 1;
  row[stride_ + at(program_.weighted.back())] = 1;
  reading_->expand(program_, of);
}

double Series::reach(int orders, double h) {
  if (!closer_) return std::numeric_limits<double>::infinity();
  return CloserSeries::reach(program_,
                             {static_cast<std::size_t>(orders), stride_, nullptr, 0, nullptr, rows(), nullptr}, h);
}
double Series::blur() { return closer_ ? closer_->blur(program_, row(0)) : 0; }
double Series::blur_of_trial() { return closer_ ? closer_->blur(program_, trial_.data()) : 0; }

void Series::expand_closely(const double* x, double t) {
  closer_->expand(program_, {static_cast<std::size_t>(order_), stride_, x, t, nullptr, rows(), lanes_.data()});
}

void Series::begin(double* row, bool bounded) {
  if (unrolled_) {
    unrolled_->begin(program_, row);
  } else {
    reading_->begin(program_, row, bounded);
  }
}

bool Series::defined(const double* x, double t) {
  std::copy_n(x, program_.variables, trial_.data() + Program::first_variable);
  trial_[at(program_.time())] = t;
  begin(trial_.data());
  for (std::size_t i = 0; i < program_.moving; ++i)
    if (!std::isfinite(trial_[at(program_.rate[i])]))
      return !program_.partial && !program_.steep.empty();  // a steep function in a divisor may overflow harmlessly
  return true;
}

}  // namespace least::tape
