#include "core/variations/control_motion.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

namespace least::variations {

ControlMotion::ControlMotion(tape::Program varied, int order)
    : tangents_(std::move(varied), order, true), columns_(tangents_.columns()), size_(tangents_.moving()) {
  begins_.resize(tape::StepTangents::steps * columns_);
  directions_.resize(begins_.size());
  fours_.resize(lanes * columns_);
  product_.resize(lanes * size_);
  change_.resize(2 * size_);
}

std::size_t ControlMotion::numbers(const tape::Program& varied) {
  constexpr int usual = 30;
  return tape::StepTangents::numbers(varied, usual, true);
}

void ControlMotion::start(std::vector<double> direction) {
  exponent_ = 0;
  random_ = 0;
  here_ = {std::move(direction), std::vector<double>(columns_), std::vector<double>(columns_),
           std::vector<double>(columns_)};
  there_ = here_;
}

/// Scales u and v to about size 1, as directions may grow without bound.
void ControlMotion::rescale() {
  double size = 0;
  for (const double component : here_.u) size = std::max(size, std::abs(component));
  const int by = size > 0 && std::isfinite(size) ? -std::ilogb(size) : 0;
  if (by == 0) return;
  exponent_ -= by;
  for (auto* numbers : {&here_.u, &here_.low, &here_.v})
    for (double& component : *numbers) component = std::ldexp(component, by);
}

/// perturbed returns x changed at random by at most ε|x|, one or two units in the last place.
double ControlMotion::perturbed(double x) {
  random_ = random_ * 6364136223846793005U + 1442695040888963407U;
  return x + (static_cast<double>(random_ >> 62U) - 1.5) * (0.67 * std::numeric_limits<double>::epsilon()) * x;
}

/// product_ = matrix · fours_, for the four interleaved columns.
void ControlMotion::multiply(const double* matrix) {
  for (std::size_t i = 0; i < size_; ++i, matrix += columns_) {
    tape::Four sum{}, from;
    for (std::size_t c = 0; c < columns_; ++c) {
      std::memcpy(&from, fours_.data() + lanes * c, sizeof(from));
      sum.lane += matrix[c] * from.lane;
    }
    std::memcpy(product_.data() + lanes * i, &sum, sizeof(sum));
  }
}

void ControlMotion::prepare(std::span<const double> begins, std::span<const double> times,
                            std::span<const double> lengths, const tape::StepTangents& matrices) {
  rescale();
  for (std::size_t i = 0; i < columns_; ++i) {
    fours_[lanes * i] = here_.e[i];
    fours_[lanes * i + 1] = here_.u[i] + here_.v[i];
    fours_[lanes * i + 2] = fours_[lanes * i + 3] = 0;
  }
  for (std::size_t step = 0; step < times.size(); ++step) {
    const std::size_t first = step * columns_;
    for (std::size_t i = 0; i < columns_; ++i) {  // parameters are not perturbed
      const double x = begins[first + i] + fours_[lanes * i], u = fours_[lanes * i + 1];
      begins_[first + i] = i < size_ ? perturbed(x) : x;
      directions_[first + i] = i < size_ ? perturbed(u) : u;
    }
    multiply(matrices.change(step));
    for (std::size_t i = 0; i < product_.size(); ++i) fours_[i] += product_[i];
  }
  tangents_.expand(std::span(begins_).first(times.size() * columns_), times,
                   std::span(directions_).first(times.size() * columns_));
  tangents_.find_changes_along(lengths);
}

void ControlMotion::move(const Step& step, const double* change, Place& to) {
  const std::size_t first = step.place * columns_;
  for (std::size_t i = 0; i < columns_; ++i) {
    double* const four = fours_.data() + lanes * i;
    four[0] = four[1] = four[3] = 0;
    four[2] = here_.u[i];
    to.u[i] = here_.u[i];  // components of parameters do not change
    if (i >= size_) continue;
    four[0] = here_.e[i] - ((begins_[first + i] - step.from[i]) - step.low_from[i]);
    four[1] = here_.v[i] - ((directions_[first + i] - here_.u[i]) - here_.low[i]);
  }
  multiply(step.matrix);
  for (std::size_t i = 0; i < size_; ++i) {
    const double* const made = product_.data() + lanes * i;
    const double moved = (step.to[i] - step.from[i]) + (step.low_to[i] - step.low_from[i]);
    to.e[i] = here_.e[i] + (made[0] + (change[i] - moved));
    to.v[i] = here_.v[i] + (made[1] + (change[size_ + i] - made[2]));
    const double start = here_.u[i], grown = made[2] + here_.low[i], end = start + grown, back = end - start;
    to.u[i] = end;
    to.low[i] = (start - (end - back)) + (grown - back);
  }
}

void ControlMotion::take(const Step& step) {
  move(step, tangents_.change_along(step.place), there_);
  std::swap(here_, there_);
}

void ControlMotion::take_part(const Step& step, double h) {
  tangents_.change_along_in(h, step.place, change_.data());
  move(step, change_.data(), there_);
  std::swap(here_, there_);
}

std::vector<double> ControlMotion::look(const Step& step, double h) {
  tangents_.change_along_in(h, step.place, change_.data());
  move(step, change_.data(), there_);
  std::vector<double> seen;
  for (std::size_t i = 0; i < size_; ++i)
    seen.push_back(std::ldexp(there_.u[i] + (there_.v[i] + there_.low[i]), exponent_));
  return seen;
}

}  // namespace least::variations
