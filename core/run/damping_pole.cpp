#include "core/run/damping_pole.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace least {
namespace {

constexpr double no_pole = std::numeric_limits<double>::infinity();

/// PoleSearch looks for a pole of α near points of a span that are so far apart.
class PoleSearch {
 public:
  PoleSearch(const ProblemTable& problem, double spacing) : problem_(problem), spacing_(spacing) {}

  /// Where α changes its sign, or ceases to be defined, between `low` and `high`: that place, if α is infinite there.
  double at_change(double low, double high) const {
    const bool positive = problem_.damping(low) > 0, defined = !std::isnan(problem_.damping(low));
    for (double middle = std::midpoint(low, high); low < middle && middle < high; middle = std::midpoint(low, high)) {
      const double damping = problem_.damping(middle);
      (std::isnan(damping) != defined && (damping > 0) == positive ? low : high) = middle;
    }
    return pole_between(low, high);
  }

  /// Where |α| is largest between `low` and `high`, by golden sections: that place, if α is infinite there.
  double at_maximum(double low, double high) const {
    constexpr double part = 1 / std::numbers::phi, growth = 100;
    constexpr int first = 20,
                  most = 90;  // a pole grows by `growth` within the first sections, a smooth maximum does not
    const double before = std::max(size(low), size(high));
    double left = high - part * (high - low), right = low + part * (high - low);
    double at_left = size(left), at_right = size(right);
    for (int i = 0; i < most && low < left && left < right && right < high; ++i) {
      if (i == first && !(std::max(at_left, at_right) > growth * before)) return no_pole;
      if (at_left > at_right) {
        high = right;
        right = left;
        at_right = at_left;
        at_left = size(left = high - part * (high - low));
      } else {
        low = left;
        left = right;
        at_left = at_right;
        at_right = size(right = low + part * (high - low));
      }
    }
    return pole_between(low, high);
  }

  /// Whether |α| grows towards t, from either side, at least like the inverse of the distance.
  bool diverges(double t) const {
    constexpr double near = 1e-3, nearer = 1e-6, finest = 1e3, least_share = 0.5;
    const double close = std::max(nearer * spacing_, finest * std::numeric_limits<double>::epsilon() * std::abs(t));
    const double apart = std::max(near * spacing_, 1e2 * close);
    return std::ranges::any_of(std::array{-1.0, 1.0}, [&](double side) {
      return size(t + side * close) * close >= least_share * size(t + side * apart) * apart;
    });
  }

 private:
  /// For neighbouring numbers: the one at which α is computed as infinite, if there is one, else the first.
  double pole_between(double low, double high) const {
    if (!diverges(low)) return no_pole;
    return std::isinf(problem_.damping(high)) ? high : low;
  }
  double size(double t) const { return std::abs(problem_.damping(t)); }
  const ProblemTable& problem_;
  double spacing_;
};

}  // namespace

double damping_pole(const ProblemTable& problem, double start, double end) {
  constexpr int looks = 256;
  const ProblemTraits& traits = problem.traits;
  if (!traits.linear_contact || traits.constant_damping || !std::isfinite(end) || problem.period() > 0) return no_pole;
  const double spacing = (end - start) / looks;
  const PoleSearch search(problem, spacing);
  std::array<double, looks + 1> at;
  for (int k = 0; k <= looks; ++k) at[static_cast<std::size_t>(k)] = problem.damping(start + k * spacing);
  for (int k = 1; k <= looks; ++k) {
    const auto here = static_cast<std::size_t>(k);
    const double t = start + k * spacing, before = at[here - 1], now = at[here];
    double found = no_pole;
    if (before * now < 0 || (std::isnan(now) && !std::isnan(before))) found = search.at_change(t - spacing, t);
    const bool largest = k < looks && std::abs(now) >= std::abs(before) && std::abs(now) >= std::abs(at[here + 1]);
    if (found == no_pole && largest) found = search.at_maximum(t - spacing, t + spacing);
    if (k == looks && std::isinf(now) && search.diverges(t)) found = end;
    if (found <= end) return found;
  }
  return no_pole;
}

}  // namespace least
