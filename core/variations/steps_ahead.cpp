#include "core/variations/steps_ahead.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

namespace least::variations {
namespace {

/// Factor of the tolerance: Taylor terms of derivatives exceed those of the motion by about the order, and discarding
/// precomputed steps costs more than taking slightly shorter ones. With this factor none are discarded in Kepler orbits
/// and in the Lorenz equations.
constexpr double closer = 1.0 / 1024;
constexpr std::size_t most_steps = tape::StepTangents::steps;

bool is_finite(std::span<const double> numbers) {
  return std::ranges::all_of(numbers, [](double number) { return std::isfinite(number); });
}

}  // namespace

bool StepsAhead::suit(const tape::Program& varied, std::size_t directions) {
  // Without precomputed steps, reading the program costs as much as some six directions.
  constexpr std::size_t always = 8, most_numbers = 1 << 19;
  return tape::StepTangents::suits(varied) && varied.variables <= always + 2 * directions &&
         numbers(varied) <= most_numbers;
}

std::size_t StepsAhead::numbers(const tape::Program& varied) {
  constexpr int usual = 30;
  return tape::StepTangents::numbers(varied, usual);
}

StepsAhead::StepsAhead(tape::Program motion, tape::Program varied, double tolerance, int order)
    : expansion_(std::move(motion), closer * tolerance, order),
      tangents_(std::move(varied), expansion_.order()),
      size_(expansion_.program().variables),
      columns_(tangents_.columns()) {
  begins_.resize(most_steps * columns_);
  for (auto* numbers : {&times_, &lengths_, &ends_}) numbers->resize(most_steps);
  for (auto* numbers : {&states_, &lows_}) numbers->resize(most_steps * size_);
}

bool StepsAhead::next(std::span<const double> y, std::span<const double> low, double t, double least) {
  return at_ < count_ || make(y, low, t, least);
}

bool StepsAhead::make(std::span<const double> y, std::span<const double> low, double t, double least) {
  at_ = count_ = 0;
  std::span<const double> from = y.first(size_), kept = low.first(size_);
  const std::span rest = y.subspan(size_);
  while (count_ < most_steps) {
    expansion_.move(from.data(), t);
    const double h = part_ * expansion_.step(), end = t + h;
    if (!(end - t > std::max(least, 1e-13 * std::abs(t))) || !std::isfinite(end)) break;
    const std::span state = std::span(states_).subspan(count_ * size_, size_),
                    rounded = std::span(lows_).subspan(count_ * size_, size_);
    expansion_.evaluate(end - t, from.data(), kept.data(), state.data(), rounded.data());
    if (!is_finite(state) || !expansion_.defined(state.data(), end)) break;
    double* const begin = begins_.data() + count_ * columns_;
    std::ranges::copy(rest, std::ranges::copy(from, begin).out);
    times_[count_] = t;
    lengths_[count_] = end - t;
    ends_[count_] = t = end;
    from = state;
    kept = rounded;
    ++count_;
  }
  if (count_ == 0) return false;
  tangents_.expand(std::span(begins_).first(count_ * columns_), std::span(times_).first(count_));
  tangents_.find_changes(std::span(lengths_).first(count_));
  if (control_) {
    low_.assign(low.begin(), low.begin() + static_cast<std::ptrdiff_t>(size_));
    control_->prepare(begins_, std::span(times_).first(count_), std::span(lengths_).first(count_), tangents_);
  }
  part_ = std::min(1.0, 1.003 * part_);
  return true;
}

void StepsAhead::control(const tape::Program& varied, int order, std::vector<double> direction) {
  control_ = std::make_unique<ControlMotion>(varied, order);
  control_->start(std::move(direction));
}

ControlMotion::Step StepsAhead::step_to(std::span<const double> y, std::span<const double> low,
                                        const double* matrix) const {
  const std::span<const double> kept = low_, lows = lows_;
  return {at_,
          matrix,
          std::span(begins_).subspan(at_ * columns_, size_),
          at_ == 0 ? kept : lows.subspan((at_ - 1) * size_, size_),
          y,
          low};
}

std::vector<double> StepsAhead::control_at(double h, std::span<const double> y, std::span<const double> low) {
  matrix_.resize(size_ * columns_);
  tangents_.change_in(h, at_, matrix_.data());
  return control_->look(step_to(y, low, matrix_.data()), h);
}

void StepsAhead::take() {
  if (control_) control_->take(step_to(state(), low(), tangents_.change(at_)));
  ++at_;
}

void StepsAhead::take_part(double h, std::span<const double> y, std::span<const double> low) {
  if (!control_) return;
  matrix_.resize(size_ * columns_);
  tangents_.change_in(h, at_, matrix_.data());
  control_->take_part(step_to(y, low, matrix_.data()), h);
}

void StepsAhead::leave(double shorter) {
  at_ = count_ = 0;
  part_ = std::max(0.1, part_ * shorter);
}

/// product_ = matrix · u
void StepsAhead::multiply(const double* matrix, std::span<const double> u, std::size_t lanes) {
  product_.resize(size_ * lanes);
  for (std::size_t i = 0; i < size_; ++i, matrix += columns_)
    for (std::size_t d = 0; d < lanes; d += 4) {
      tape::Four sum{}, from;
      for (std::size_t c = 0; c < columns_; ++c) {
        std::memcpy(&from, u.data() + c * lanes + d, sizeof(from));
        sum.lane += matrix[c] * from.lane;
      }
      std::memcpy(product_.data() + i * lanes + d, &sum, sizeof(sum));
    }
}

double StepsAhead::largest() const {
  double most = 0;
  for (const double here : product_)
    if (!(std::abs(here) <= most)) {
      most = std::abs(here);
      if (std::isnan(most)) break;
    }
  return most;
}

std::pair<double, double> StepsAhead::last_terms(std::span<const double> u, std::size_t lanes) {
  multiply(tangents_.last_term(at_), u, lanes);
  const double last = largest();
  multiply(tangents_.term_before(at_), u, lanes);
  return {last, largest()};
}

void StepsAhead::change(std::span<double> u, std::span<double> low, std::size_t lanes) {
  multiply(tangents_.change(at_), u, lanes);
  add(u, low);
}

void StepsAhead::change_in(double h, std::span<double> u, std::span<double> low, std::size_t lanes) {
  matrix_.resize(size_ * columns_);
  tangents_.change_in(h, at_, matrix_.data());
  multiply(matrix_.data(), u, lanes);
  add(u, low);
}

/// add adds product_ to u with compensated summation.
void StepsAhead::add(std::span<double> u, std::span<double> low) {
  for (std::size_t place = 0; place < product_.size(); ++place) {
    const double start = u[place], change = product_[place] + low[place], to = start + change, back = to - start;
    u[place] = to;
    low[place] = (start - (to - back)) + (change - back);
  }
}

}  // namespace least::variations
