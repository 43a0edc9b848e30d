#include "core/schemes/taylor.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace least::taylor {
namespace {

using tape::Index;
using tape::Program;

/// What a step of the order p costs, about, in nanoseconds: of a machine where a force of Kepler's costs ten.
double cost(const Program& program, double p) {
  double fixed = 60, step = 4;
  for (const auto* list : {&program.linear, &program.steps})
    for (const auto& s : *list) fixed += s.function == tape::Op::constant ? 2 : 12;
  step += 2.2 * static_cast<double>(program.steps.size()) + static_cast<double>(program.variables);
  const double groups = static_cast<double>((program.lane_a.size() + 3) / 4);
  return fixed + p * (step + 3 * groups + 0.25 * groups * p);
}

/// Jorba and Zou's argument with that cost: a step is ρ ε^{1/p} long where the series converges up to ρ, (ε p!)^{1/p}
/// where it converges everywhere.
int cheapest_order(const Program& program, double tolerance) {
  int best = 4;
  double least = std::numeric_limits<double>::infinity();
  for (int p = 4; p <= 40; ++p) {
    const double length = (std::log(tolerance) + (program.whole ? std::lgamma(p + 1.0) : 0)) / p;
    const double each = std::log(cost(program, p)) - length;
    if (each < least) best = p, least = each;
  }
  return best;
}

}  // namespace

Expansion::Expansion(const Program& program, double tolerance, int order)
    : series_(program, order > 0 ? order : cheapest_order(program, tolerance)),
      tolerance_(tolerance),
      variables_(program.variables),
      moving_(program.moving) {}

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
  if (used_ == 0) return 0;
  const double scale = std::max(1.0, largest(0)), allowed = std::log(tolerance_ * scale);
  double h = std::log(longest * std::max(1.0, std::abs(t_)));
  for (int k = used_; k > 0 && k > used_ - 2; --k)
    if (const double size = largest(k); size > 0) h = std::min(h, (allowed - std::log(size)) / k);
  // Where these two happen to vanish, as on an axis of symmetry, those before them speak: cₖ ≤ rᵏ is to hold.
  const double decay = std::log(tolerance_) / used_, r = std::exp(decay - h);
  double power = slack * scale * std::exp((used_ - 2) * (decay - h));
  for (int k = used_ - 2; k > 0 && k > used_ - looked_at; --k, power /= r)
    if (const double size = largest(k); size > power) h = std::min(h, decay - std::log(size / scale) / k);
  h = std::exp(h);
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
  for (std::size_t i = 0; i < variables_; ++i) {
    double sum = series_.coefficients(used_)[i];
    for (int k = used_ - 1; k > 0; --k) sum = sum * h + series_.coefficients(k)[i];
    const double from = y[i], change = sum * h + low[i], to = from + change;
    const double back = to - from;
    low[i] = (from - (to - back)) + (change - back);
    y[i] = to;
  }
}

}  // namespace least::taylor
