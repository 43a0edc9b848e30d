#include "core/tape/side_change.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace least::tape {

double value_at(std::span<const double> c, double time) {
  double sum = 0;
  for (std::size_t k = c.size(); k-- > 0;) sum = sum * time + c[k];
  return sum;
}

double told_until(std::span<const double> c, double end, double tolerance) {
  constexpr double shorter = 0.9;
  constexpr int most_rounds = 400;
  std::size_t known = 0;  // high orders may overflow
  while (known < c.size() && std::isfinite(c[known])) ++known;
  if (known < 3) return end;
  for (int round = 0; round < most_rounds; ++round, end *= shorter) {
    double power = 1, most = 0, last = 0;
    for (std::size_t k = 0; k < known; ++k, power *= end) {
      double& larger = k + 2 < known ? most : last;
      larger = std::max(larger, std::abs(c[k]) * power);
    }
    if (std::isfinite(most) && last <= tolerance * most) break;
  }
  return end;
}

namespace {

/// The polynomial expanded about the middle of a stretch, in the variable (time − middle)/half length.
class Centred {
 public:
  Centred(std::span<const double> c, const Stretch& on) {
    const double middle = 0.5 * (on.low + on.high), half = 0.5 * (on.high - on.low);
    std::ranges::copy(c, about_.begin());
    for (std::size_t first = 0; first + 1 < c.size(); ++first)  // repeated Horner scheme
      for (std::size_t k = c.size() - 1; k-- > first;) about_[k] += about_[k + 1] * middle;
    double power = 1;
    for (std::size_t k = 0; k < c.size(); ++k, power *= half) {
      about_[k] *= power;
      if (k > 0) others_ += std::abs(about_[k]);
      if (k > 1) bend_ += static_cast<double>(k) * std::abs(about_[k]);
    }
  }
  double value() const { return about_[0]; }
  bool has_no_zero() const { return std::abs(about_[0]) > others_; }
  bool is_monotone() const { return std::abs(about_[1]) >= bend_; }

 private:
  std::array<double, most_terms> about_{};
  double others_ = 0, bend_ = 0;
};

}  // namespace

std::optional<Stretch> first_change(std::span<const double> c, double end, bool negative) {
  constexpr int most_looks = 2000;      // a value that is almost zero throughout would be halved everywhere
  constexpr double shortest = 0x1p-44;  // part of [0, end]: two zeros so close count as none
  const auto left = [&](double time) { return (value_at(c, time) < 0) != negative; };
  std::array<double, 64> ends;  // ends of the stretches that are still to be examined, the last one first
  std::size_t count = 0;
  ends[count++] = end;
  double low = 0;
  for (int look = 0; count > 0; ++look) {
    const double high = ends[count - 1];
    const Centred here(c, {low, high});
    const bool short_one = high - low <= shortest * end || count == ends.size() || look >= most_looks;
    if (!short_one && !here.has_no_zero() && !here.is_monotone()) {
      ends[count++] = 0.5 * (low + high);
      continue;
    }
    if (left(high)) return Stretch{low, high};
    low = high;
    --count;
  }
  return std::nullopt;
}

}  // namespace least::tape
