#include "core/schemes/taylor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace least::taylor {
namespace {

using tape::Index;
using tape::Program;

constexpr int most_chosen = 40;

/// What a step of the order p costs, about, in nanoseconds: measured where a leapfrog step of Kepler's problem
/// takes 16. The terms of high orders hide behind the chain of the new ones.
double cost(const Program& program, double p) {
  double fixed = 120;
  for (std::size_t i = 0; i < program.motion_steps; ++i)
    fixed += program.steps[i].function == tape::Op::constant ? 2 : 12;
  const auto steps = static_cast<double>(program.motion_steps);
  const std::size_t fours = (program.motion_lanes + 3) / 4;
  const auto groups = static_cast<double>(fours);
  return fixed + p * (2 + 4 * steps + 3 * groups + 0.1 * groups * p);
}

/// ln n!
double log_factorial(int n) {
  static const auto all = [] {
    std::array<double, tape::Series::most_orders + 1> sums{};
    for (std::size_t k = 2; k < sums.size(); ++k) sums[k] = sums[k - 1] + std::log(static_cast<double>(k));
    return sums;
  }();
  return all[static_cast<std::size_t>(n)];
}

/// Jorba and Zou's argument with that cost: a step is ρ ε^{1/p} long where the series converges up to ρ, (ε p!)^{1/p}
/// where it converges everywhere. There its terms first grow, to eʰ, and what rounding takes from them has to stay
/// below the tolerance.
int cheapest_order(const Program& program, double tolerance) {
  const double digits = -std::log(tolerance), longest = std::log(std::max(1.5, std::log(0x1p53 * tolerance)));
  int best = 4;
  double before = std::numeric_limits<double>::infinity();
  for (int p = best; p <= most_chosen; ++p) {
    const double length = ((program.whole ? log_factorial(p) : 0) - digits) / p;
    const double each = std::log(cost(program, p)) - length;
    if (!(each < before) || (program.whole && length > longest)) break;
    best = p, before = each;
  }
  return best;
}

double raised(double x, int n) {
  double power = 1;
  for (; n > 0; n /= 2, x *= x)
    if (n % 2) power *= x;
  return power;
}

tape::Series series_of(Program program, double tolerance, int order) {
  const int chosen = order > 0 ? order : cheapest_order(program, tolerance);
  return {std::move(program), chosen};
}

}  // namespace

Expansion::Expansion(Program program, double tolerance, int order)
    : series_(series_of(std::move(program), tolerance, order)),
      log_tolerance_(std::log(tolerance)),
      root_(std::exp(log_tolerance_ / series_.order())),
      variables_(series_.program().variables),
      moving_(series_.program().moving) {}

void Expansion::limit(double rate) {
  if (rate != 0)
    longest_ = std::exp((log_tolerance_ + log_factorial(series_.order())) / series_.order()) / std::abs(rate);
}

double Expansion::largest(int k) const {
  const double* c = series_.coefficients(k);
  double most = 0;
  for (std::size_t i = 0; i < moving_; ++i) {
    const double size = std::abs(c[i]);
    if (!(size <= most)) most = size;  // NaN comes in and stays
    if (std::isnan(size)) return size;
  }
  return most;
}

void Expansion::move(const double* y, double t) {
  if (t == t_ && std::equal(y, y + variables_, series_.coefficients(0))) return;
  series_.expand(y, t);
  t_ = t;
  used_ = series_.order();
  if (std::isfinite(largest(used_))) return;
  used_ = 0;  // near a singularity high orders overflow before low ones mean nothing
  while (std::isfinite(largest(used_ + 1))) ++used_;
}

double Expansion::step() const {
  // Beyond which nothing is asked of a free motion; the next may be as much longer.
  constexpr double longest = 0x1p20;
  constexpr double slack = 10;  // by how much other coefficients may exceed what the last two promise
  constexpr int looked_at = 8;
  constexpr double kept = 1.0 / 16;  // of the tolerance the last terms: the first left out are a quarter of them
  if (used_ == 0) return 0;
  const double scale = std::max(1.0, largest(0)), allowed = std::log(kept * scale) + log_tolerance_;
  double log_h = std::log(std::max(longest, std::abs(t_) / longest));
  for (int k = used_; k > 0 && k > used_ - 2; --k)
    if (const double size = largest(k); size > 0) log_h = std::min(log_h, (allowed - std::log(size)) / k);
  double h = std::exp(log_h);
  // Where these two happen to vanish, as on an axis of symmetry, those before them speak: cₖ ≤ rᵏ is to hold.
  const double root = used_ == series_.order() ? root_ : std::exp(log_tolerance_ / used_), r = root / h;
  double power = slack * kept * scale * raised(r, used_ - 2);
  for (int k = used_ - 2; !series_.program().whole && k > 0 && k > used_ - looked_at; --k, power /= r)
    if (const double size = largest(k); size > power) h = std::min(h, root * std::pow(kept * scale / size, 1.0 / k));
  h = std::min(h, longest_);
  for (const Index pole : series_.program().poles) {  // never over it, whatever the coefficients say
    const double ahead = -series_.coefficient(pole, 0) / series_.coefficient(pole, 1);
    if (ahead > 0) h = std::min(h, 0.5 * ahead);
  }
  return series_.program().switches.empty() ? h : until_switch(h);
}

/// Up to h, or to shortly behind the first time at which a formula changes.
double Expansion::until_switch(double h) const {
  constexpr int parts = 8;
  double end = h;
  for (const Index value : series_.program().switches) {
    const auto difference = [&](double time) {
      double sum = 0;
      for (int k = used_ - 1; k >= 0; --k) sum = sum * time + series_.coefficient(value, k);
      return sum;
    };
    const bool before = difference(0) < 0;
    for (int part = 1; part <= parts; ++part) {
      double low = end * (part - 1) / parts, high = end * part / parts;
      if ((difference(high) < 0) == before) continue;
      for (int i = 0; i < 60 && high - low > 1e-16 * high; ++i) {
        const double middle = 0.5 * (low + high);
        ((difference(middle) < 0) == before ? low : high) = middle;
      }
      const double beyond = 4 * std::numeric_limits<double>::epsilon();
      end = std::min(end, high * (1 + beyond) + beyond * std::abs(t_));
      break;
    }
  }
  return end;
}

void Expansion::evaluate(double h, double* low, double* y) const {
  for (std::size_t begin = 0; begin < variables_; begin += 4) {
    std::array<double, 4> sum{};
    for (int k = used_; k > 0; --k)
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = sum[i] * h + series_.coefficients(k)[begin + i];
    for (std::size_t i = begin; i < std::min(begin + 4, variables_); ++i) {
      const double from = y[i], change = sum[i - begin] * h + low[i], to = from + change;
      const double back = to - from;
      low[i] = (from - (to - back)) + (change - back);
      y[i] = to;
    }
  }
}

}  // namespace least::taylor
