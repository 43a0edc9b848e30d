#include "core/run/scales.hpp"

#include <limits>

namespace least {
namespace {

constexpr double no_rate = -std::numeric_limits<double>::infinity();

/// log_sum returns ln Σ |c_k| τᵏ over from ≤ k < to from the logarithms ln |c_k|, so that no unit makes it overflow.
double log_sum(std::span<const double> logs, double log_tau, std::size_t from, std::size_t to) {
  double most = no_rate, sum = 0;
  for (std::size_t k = from; k < to; ++k) most = std::max(most, logs[k] + static_cast<double>(k) * log_tau);
  if (!(most > no_rate)) return no_rate;
  for (std::size_t k = from; k < to; ++k) sum += std::exp(logs[k] + static_cast<double>(k) * log_tau - most);
  return most + std::log(sum);
}

/// log_time returns ln of the time at which the terms of higher order become as large as those of velocity and
/// acceleration (or of the first order that does not vanish and the next); infinite if there are no higher terms.
double log_time(std::span<const double> logs) {
  constexpr double widest = 1500;  // beyond ln of the largest double
  const std::size_t end = logs.size();
  std::size_t first = 1;
  if (logs[1] == no_rate && logs[2] == no_rate)
    while (first < end && logs[first] == no_rate) ++first;
  if (first + 2 >= end) return -no_rate;
  const auto excess = [&](double log_tau) {
    return log_sum(logs, log_tau, first + 2, end) - log_sum(logs, log_tau, first, first + 2);
  };
  if (log_sum(logs, 0, first + 2, end) == no_rate) return -no_rate;
  double low = -widest, high = widest;
  for (int k = 0; k < 60; ++k) {
    const double middle = (low + high) / 2;
    (excess(middle) > 0 ? high : low) = middle;
  }
  return high;
}

}  // namespace

Scales scales_of_series(std::span<const std::vector<double>> orders, std::size_t coordinates, std::size_t momenta) {
  constexpr double turn = 3;  // the time so defined is about three times 1/ω of an oscillator
  double log_tau = -no_rate;
  std::vector<double> logs(orders.size());
  for (std::size_t i = 0; i < coordinates; ++i) {
    for (std::size_t k = 0; k < orders.size(); ++k) logs[k] = std::log(std::abs(orders[k][i]));
    if (!std::ranges::all_of(logs, [](double x) { return x < std::numeric_limits<double>::infinity(); })) return {};
    log_tau = std::min(log_tau, log_time(logs));
  }
  Scales scales;
  const double tau = std::exp(log_tau) / turn;
  if (!(tau > 0 && std::isfinite(tau))) return {};
  scales.time = tau;
  const auto size = [&](std::size_t k, std::size_t i) { return std::abs(orders[k][i]); };
  for (std::size_t i = 0; i < coordinates; ++i) {
    scales.length = std::max(scales.length, (size(1, i) + size(2, i) * tau) * tau);
    if (momenta == 0) continue;
    const double p = size(0, i + momenta) + size(1, i + momenta) * tau;
    scales.energy += 0.5 * p * (size(1, i) + 2 * size(2, i) * tau);
  }
  return scales;
}

Scales scales_of_motion(tape::Program program, const double* start, double t, std::size_t components,
                        std::size_t half) {
  constexpr int order = 8;  // for a start at rest where the force has no slope, order 6 is the first to turn the motion
  tape::Series series(std::move(program), order, false);
  series.expand(start, t);
  std::vector<std::vector<double>> orders;
  for (int k = 0; k <= order; ++k) orders.emplace_back(series.coefficients(k), series.coefficients(k) + components);
  return scales_of_series(orders, half > 0 ? half : components, half);
}

Scales scales_of_orbit(double mu, double r, double v_squared) {
  // At the periapsis of a long ellipse the motion is far faster than its period suggests: the time is bounded by that
  // of the start.
  constexpr double longest = 32;  // in units of the local time √(r³/μ)
  const double energy = mu / r - v_squared / 2;
  if (!(mu > 0 && r > 0 && energy > 0)) return {};
  const double a = mu / (2 * energy), here = r * std::sqrt(r / mu);
  return {std::min(a * std::sqrt(a / mu), longest * here), energy, a};
}

}  // namespace least
