#include "core/run/scales.hpp"

#include <limits>

namespace least {
namespace {

constexpr double no_rate = -std::numeric_limits<double>::infinity();
constexpr double no_time = std::numeric_limits<double>::quiet_NaN();

/// log_sum returns the logarithm of a sum of which all terms are given by their logarithms, so that no unit makes it
/// overflow.
double log_sum(std::span<const double> logs) {
  const double most = logs.empty() ? no_rate : std::ranges::max(logs);
  if (!(most > no_rate)) return no_rate;
  double sum = 0;
  for (const double one : logs) sum += std::exp(one - most);
  return most + std::log(sum);
}

/// is_cyclic tells whether a momentum stays what it is: the motion of its coordinate, as that of an angle, has no time
/// of its own.
bool is_cyclic(std::span<const std::vector<double>> orders, std::size_t momentum) {
  return std::ranges::all_of(orders.subspan(1), [=](const auto& terms) { return terms[momentum] == 0; });
}

/// log_size returns ln of the size N_k of all terms of order k: N_k² = Σ |q_k p_k₋₁| over the coordinates, or Σ x_k²
/// over the variables of a flow. A coordinate times its momentum is an action, whatever the coordinate is measured in:
/// lengths and angles may be added so. For p = m dq/dt it is k m q_k². Infinite where a term is not finite.
double log_size(std::span<const std::vector<double>> orders, std::size_t k, std::size_t coordinates,
                std::size_t momenta) {
  std::vector<double> logs;
  for (std::size_t i = 0; i < coordinates; ++i) {
    if (momenta > 0 && is_cyclic(orders, i + momenta)) continue;
    const double term = orders[k][i], partner = momenta > 0 ? orders[k - 1][i + momenta] : term;
    if (!std::isfinite(term) || !std::isfinite(partner)) return -no_rate;
    logs.push_back(std::log(std::abs(term)) + std::log(std::abs(partner)));
  }
  return log_sum(logs) / 2;
}

/// log_time returns ln of the time at which the terms of orders above `low` become as large as those up to `low`;
/// `logs` begins with ln N_1. It is NaN where either do not exist.
double log_time(std::span<const double> logs, std::size_t low) {
  constexpr double widest = 1500;  // beyond ln of the largest double
  if (logs.size() <= low) return no_time;
  if (log_sum(logs.first(low)) == no_rate || log_sum(logs.subspan(low)) == no_rate) return no_time;
  std::vector<double> terms(logs.size());
  const auto later_terms_win = [&](double log_tau) {
    for (std::size_t k = 0; k < logs.size(); ++k) terms[k] = logs[k] + static_cast<double>(k) * log_tau;
    return log_sum(std::span(terms).subspan(low)) > log_sum(std::span(terms).first(low));
  };
  double least = -widest, most = widest;
  for (int k = 0; k < 60; ++k) {
    const double middle = (least + most) / 2;
    (later_terms_win(middle) ? most : least) = middle;
  }
  return most;
}

}  // namespace

Scales scales_of_series(std::span<const std::vector<double>> orders, std::size_t coordinates, std::size_t momenta) {
  // A start near a symmetric one has first terms that almost vanish in some coordinates, or in all where a force begins
  // from zero. Sums over all coordinates and over several orders change as little as the start does.
  constexpr std::size_t low = 4;
  constexpr double turn = 3;  // in 1/ω the time so defined is about 4 for an oscillator, 2 for what is far from linear
  std::vector<double> logs;
  for (std::size_t k = 1; k < orders.size(); ++k) {
    const double size = log_size(orders, k, coordinates, momenta);
    if (!(size < -no_rate)) break;  // in units that are too small for orders so high
    logs.push_back(size);
  }
  Scales scales;
  const double tau = std::exp(log_time(logs, low)) / turn;
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
  // For a start at rest where the force has no slope, order 6 is the first to turn the motion. Higher ones would notice
  // fast oscillations of the smallest amplitude.
  constexpr int order = 8;
  tape::Series series(std::move(program), order, false);
  series.expand(start, t);
  std::vector<std::vector<double>> orders;
  for (int k = 0; k <= order; ++k) orders.emplace_back(series.coefficients(k), series.coefficients(k) + components);
  return scales_of_series(orders, half > 0 ? half : components, half);
}

Scales scales_of_orbit(double mu, double r, double v_squared) {
  // At the periapsis of a long ellipse the motion is far faster than its period suggests, and a body that escapes has
  // no period: the time is bounded by that of the start.
  constexpr double longest = 32;  // in units of the local time √(r³/μ)
  if (!(mu > 0 && r > 0)) return {};
  const double local = mu / r, bound = local - v_squared / 2;
  const double farthest = std::cbrt(longest * longest) * r;
  const double a = 2 * farthest * bound > mu ? mu / (2 * bound) : farthest;
  const double passing = std::min(1.0, std::sqrt(2 * local / v_squared));  // of a flight by, faster than it could orbit
  return {a * std::sqrt(a / mu) * passing, std::max(mu / (2 * a), -bound), a};
}

}  // namespace least
