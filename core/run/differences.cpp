#include "core/run/differences.hpp"

#include <algorithm>
#include <cmath>

#include "core/run/control_stepper.hpp"

namespace least {
namespace {

/// The larger one; NaN stays.
double larger(double most, double x) { return std::isnan(most) || x <= most ? most : x; }

}  // namespace

Differences::Differences(const RunBackend& backend, const RunState& x, std::size_t direction, double end,
                         double tolerance)
    : backend_(backend),
      steep_(field_of(backend, nullptr), backend.steep_forces(), x.size()),
      here_{x, StateNumbers(x.size(), 0.0)},
      end_(end),
      scale_(largest(here_).first),
      tolerance_(tolerance),
      step_((end - x.t) / 100) {
  here_.slopes[direction] = 1;
}

double Differences::growth() const {
  const auto [value, slope] = largest(here_);
  return slope * scale_ / std::max(1.0, value);
}

bool Differences::advance() {
  const double shortest = 1e-13 * std::max(std::abs(time()), end_ - time());
  for (;;) {
    const double left = end_ - time(), h = std::min(step_, left);
    Point whole = here_, halves = here_;
    move(whole, h);
    move(halves, h / 2);
    halves.x.t = time() + h / 2;
    move(halves, h / 2);
    const auto [value, slope] = largest(halves);
    double error = 0;
    for (std::size_t i = 0; i < whole.x.size(); ++i) {
      error = larger(error, std::abs(whole.x[i] - halves.x[i]) / value);
      error = larger(error, std::abs(whole.slopes[i] - halves.slopes[i]) / slope);
    }
    error /= 15 * tolerance_;
    if (error <= 1 && inside(halves)) {
      halves.x.t = h < left ? time() + h : end_;
      if (const double part = steep_.resolved_part(here_.x, halves.x, tolerance_); part < 1 && part * h > shortest) {
        step_ = part * h;
        continue;
      }
      here_ = halves;
      step_ = h * std::min(4.0, 0.9 / std::pow(std::max(error, 1e-6), 0.2));
      return true;
    }
    left_domain_ = error <= 1;
    step_ = error > 1 ? h * std::max(0.2, 0.9 / std::pow(error, 0.2)) : h / 4;  // NaN: a quarter
    if (step_ < (left_domain_ ? 1e-3 * left : shortest)) return false;
  }
}

/// A step of the classical scheme; the time is left to the caller.
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
    backend_.motion().rates(at.x, at.slopes.data(), 0, rates.data(), changes.data());
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

bool Differences::inside(const Point& point) const {
  return !backend_.motion().outside(point.x) && std::isfinite(point.x[0]);
}

/// Of the components of the state, and of the derivative; they are divisors.
std::pair<double, double> Differences::largest(const Point& point) {
  double value = 1e-300, slope = 1e-300;
  for (std::size_t i = 0; i < point.x.size(); ++i) {
    value = std::max(value, std::abs(point.x[i]));
    slope = std::max(slope, std::abs(point.slopes[i]));
  }
  return {value, slope};
}

}  // namespace least
