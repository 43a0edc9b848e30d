#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "core/number/asked_by_thread.hpp"
#include "core/schemes/taylor.hpp"
#include "core/tape/series_rules.hpp"
#include "core/tape/side_change.hpp"

// Steps of a Taylor series end where formulas change.

namespace least::taylor {

using tape::Index;

/// Where a motion begins on the border at which a formula changes, the series is that of the side of values ≥ 0. If the
/// motion goes to the other side, the series is replaced by that of a state across the border, as near as rounding
/// allows. Returns true if the motion comes back from there: it stays on the border, and the series has to be expanded
/// at y again. Where a thousand formulas change at once this takes seconds, so AskedByThread::goes_on() is asked.
bool Expansion::leave_border(const double* y) {
  constexpr double near = 4 * std::numeric_limits<double>::epsilon(), next_to_0 = 1e-300, longer = 16, longest = 1e3;
  const auto heading = [&](Index value) {
    int k = 1;
    while (k < series_.order() && series_.coefficient(value, k) == 0) ++k;
    return k < series_.order() ? series_.coefficient(value, k) : 0;
  };
  for (const Index value : program().switches) {
    if (series_.coefficient(value, 0) != 0 || !(heading(value) < 0)) continue;
    if (!AskedByThread::goes_on()) return false;
    double* const beside = way_.data();
    double h = std::numeric_limits<double>::min();
    do {
      for (std::size_t i = 0; i < variables_; ++i) {
        const double rate = series_.coefficients(1)[i], bend = series_.order() > 1 ? series_.coefficients(2)[i] : 0;
        const double reach = near * std::abs(y[i]) + next_to_0;
        beside[i] = y[i] + std::clamp((bend * h + rate) * h, -reach, reach);
      }
      (void)series_.defined(beside, t_);
      h *= longer;
    } while (h < longest && !(series_.value(value) < 0));
    if (!(series_.value(value) < 0)) continue;  // the time alone leads over the border
    std::copy_n(beside, variables_, slopes_.data());
    series_.expand(slopes_.data(), t_);
    if (heading(value) > 0) return true;
  }
  return false;
}

/// Returns the first of ever longer steps, from h up to `longest`, at whose end the rounded value has left its side,
/// too (`before`: it was negative). Where a motion begins at rest on the border, or slowly beside it, the rounded state
/// stays the same for a while; until it changes, the formulas of both sides give the same numbers.
double Expansion::behind_switch(Index value, bool before, double h, double longest) {
  double *const state = way_.data(), *const low = slopes_.data(), *const rest = low + variables_;
  std::fill_n(low, variables_, 0.0);
  double further = std::numeric_limits<double>::epsilon() * h;
  for (double end = h; end < longest; end = h + further, further *= 2) {
    evaluate(end, series_.coefficients(0), low, state, rest);
    (void)series_.defined(state, t_ + end);
    if ((series_.value(value) < 0) != before) return end;
  }
  return longest;
}

/// A value that chooses formulas may be faster than the motion, as sin(20t) of which the sign alone acts: so the
/// accuracy of its own series bounds the step, too.
std::optional<double> Expansion::until_switch(double& end) {
  std::array<double, tape::most_terms> terms{};
  std::optional<double> behind;
  for (const Index value : series_.program().switches) {
    double most = 0;
    for (int k = used_ - 1; k > 0; --k) most = (most + std::abs(series_.coefficient(value, k))) * end;
    if (most < std::abs(series_.coefficient(value, 0))) continue;  // it stays on its side
    if (!AskedByThread::goes_on()) break;
    for (int k = 0; k < used_; ++k) terms[tape::at(k)] = series_.coefficient(value, k);
    const std::span<const double> c(terms.data(), tape::at(used_));
    const bool before = c[0] < 0;
    end = tape::told_until(c, end, tolerance_);
    const auto change = tape::first_change(c, end, before);
    if (!change) continue;
    auto [low, high] = *change;
    double time = low > 0 ? low : 0.5 * high;
    for (int i = 0; i < 60 && high - low > 1e-16 * high; ++i) {  // Newton's method, within these two
      double sum = 0, slope = 0;
      for (int k = used_ - 1; k >= 0; --k) {
        slope = slope * time + sum;
        sum = sum * time + c[tape::at(k)];
      }
      ((sum < 0) == before ? low : high) = time;
      const double next = time - sum / slope;
      if (std::abs(next - time) <= 4 * std::numeric_limits<double>::epsilon() * time) {
        high = time;
        break;
      }
      time = low < next && next < high ? next : 0.5 * (low + high);
    }
    const double beyond = 4 * std::numeric_limits<double>::epsilon();
    end = behind_switch(value, before, std::min(end, high * (1 + beyond) + beyond * std::abs(t_)), end);
    behind = end;
  }
  return behind;
}

}  // namespace least::taylor
