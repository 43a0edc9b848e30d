#include "core/run/differences.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/run/control_stepper.hpp"

namespace least {
namespace {

/// The distance of the neighbour, relative to the sizes of the components, and the tolerance of a step of the
/// difference: errors of all steps near x = 0 of √|x| add up.
constexpr double next_to = 1e-7, slope_tolerance = 1e-5;

/// The larger of two numbers; NaN if one is.
double larger(double most, double x) { return std::isnan(most) || x <= most ? most : x; }

/// next_step returns the next step length after a step h with this error, relative to the tolerance.
double next_step(double h, double error) {
  if (std::isnan(error)) return h / 4;
  const double wanted = 0.9 / std::pow(std::max(error, 1e-6), 0.2);
  return h * (error <= 1 ? std::min(4.0, wanted) : std::max(0.2, wanted));
}

}  // namespace

Differences::Differences(const RunBackend& backend, const RunState& x, std::size_t direction, double end,
                         double tolerance)
    : backend_(backend),
      steep_(field_of(backend, nullptr), backend.steep_forces(), x.size()),
      here_{x, StateNumbers(x.size(), 0.0)},
      end_(end),
      scale_(largest(here_).first),
      tolerance_(tolerance),
      step_((end - x.t) / 100),
      sizes_(x.size(), 0.0) {
  here_.slopes[direction] = 1;
}

double Differences::growth() const {
  const auto [value, slope] = largest(here_);
  return slope * scale_ / std::max(1.0, value);
}

bool Differences::advance() {
  const double shortest = 1e-13 * std::max(std::abs(time()), end_ - time()), first = step_;
  for (std::size_t i = 0; i < sizes_.size(); ++i) sizes_[i] = std::max(sizes_[i], std::abs(here_.x[i]));
  if (apart_ > 0) apart_ = neighbour();
  for (;;) {
    const double left = end_ - time(), h = std::min(step_, left);
    Point whole = here_, halves = here_;
    move(whole, h);
    move(halves, h / 2);
    halves.x.t = time() + h / 2;
    move(halves, h / 2);
    const auto [value, slope] = largest(halves);
    double of_motion = 0, of_slopes = 0;
    for (std::size_t i = 0; i < whole.x.size(); ++i) {
      of_motion = larger(of_motion, std::abs(whole.x[i] - halves.x[i]) / value);
      of_slopes = larger(of_slopes, std::abs(whole.slopes[i] - halves.slopes[i]) / slope);
    }
    of_motion /= 15 * tolerance_;
    of_slopes /= 15 * (apart_ > 0 ? slope_tolerance : tolerance_);
    const double error = larger(of_motion, of_slopes);
    const bool accurate = error <= 1;
    left_domain_ = accurate && !inside(halves);
    step_ = left_domain_ ? h / 4 : next_step(h, error);
    if (accurate && !left_domain_ && (step_ >= shortest || h == left)) {
      halves.x.t = h < left ? time() + h : end_;
      if (const double part = steep_.resolved_part(here_.x, halves.x, tolerance_); part < 1 && part * h > shortest) {
        step_ = part * h;
        continue;
      }
      here_ = halves;
      return true;
    }
    if (step_ >= (left_domain_ ? 1e-3 * left : shortest)) continue;
    const bool goes_on = !left_domain_ && next_step(h, of_motion) >= shortest;
    lost_ = goes_on && apart_ > 0;
    if (lost_ || !goes_on) return false;
    apart_ = neighbour();
    step_ = first;
  }
}

/// move takes a step of the classical Runge–Kutta scheme; its caller advances the time.
void Differences::move(Point& point, double h) const {
  constexpr double nodes[] = {0, 0.5, 0.5, 1}, weights[] = {1, 2, 2, 1};
  const std::size_t size = point.x.size();
  Point at = point;
  StateNumbers rates(size), changes(size), moved(size, 0.0), slopes(size, 0.0);
  for (int stage = 0; stage < 4; ++stage) {
    if (stage > 0) {
      at.x.t = point.x.t + nodes[stage] * h;
      for (std::size_t i = 0; i < size; ++i) {
        at.x[i] = point.x[i] + nodes[stage] * h * rates[i];
        at.slopes[i] = point.slopes[i] + nodes[stage] * h * changes[i];
      }
    }
    find_rates(at, rates.data(), changes.data());
    for (std::size_t i = 0; i < size; ++i) {
      moved[i] += weights[stage] * rates[i];
      slopes[i] += weights[stage] * changes[i];
    }
  }
  for (std::size_t i = 0; i < size; ++i) {
    point.x[i] += h / 6 * moved[i];
    point.slopes[i] += h / 6 * slopes[i];
  }
}

void Differences::find_rates(const Point& at, double* rates, double* changes) const {
  const ProblemTable& motion = backend_.motion();
  if (apart_ == 0) return motion.rates(at.x, at.slopes.data(), 0, rates, changes);
  RunState neighbour = at.x;
  for (std::size_t i = 0; i < neighbour.size(); ++i) neighbour[i] += apart_ * at.slopes[i];
  motion.rates(at.x, rates);
  motion.rates(neighbour, changes);
  for (std::size_t i = 0; i < neighbour.size(); ++i) changes[i] = (changes[i] - rates[i]) / apart_;
}

/// neighbour returns apart_, so that the neighbour differs from the state by a small part of each component's size.
double Differences::neighbour() const {
  const auto [value, slope] = largest(here_);
  double most = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < sizes_.size(); ++i)
    if (sizes_[i] > 0 && here_.slopes[i] != 0) most = std::min(most, sizes_[i] / std::abs(here_.slopes[i]));
  return next_to * std::min(most, value / slope);
}

bool Differences::inside(const Point& point) const {
  return !backend_.motion().outside(point.x) && std::isfinite(point.x[0]);
}

/// largest returns the largest component of the state, and of the derivative, neither of them 0, since they are
/// divisors.
std::pair<double, double> Differences::largest(const Point& point) {
  double value = 1e-300, slope = 1e-300;
  for (std::size_t i = 0; i < point.x.size(); ++i) {
    value = std::max(value, std::abs(point.x[i]));
    slope = std::max(slope, std::abs(point.slopes[i]));
  }
  return {value, slope};
}

}  // namespace least
