// Samples that lie evenly along the curve that a run draws, whatever its steps: for a picture of the curve.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace least {

/// CurveThinner decides which of the rows seen so far to keep, by the arc length up to each, so that at the end `count`
/// of them can be chosen at nearly equal distances. It holds up to 32 rows for each row that is asked for, but at most
/// a million (then the distances are less equal); whenever it is full, `thin` drops about half of them.
class CurveThinner {
 public:
  static constexpr std::size_t most_asked = 100'000;

  explicit CurveThinner(std::size_t count) : count_(count), most_(std::min<std::size_t>(32 * count, 1'000'000)) {}

  /// parts returns the number of parts into which the way to the next row, of length `chord`, has to be divided; there
  /// a fraction `share` of the run's time is over (unknown where the end of the run is). At first these are `count`
  /// parts. Once a quarter of the room is used, the length of the whole curve is extrapolated from `share`, so that a
  /// run of many steps need not be thinned again and again.
  std::size_t parts(double chord, double share) const {
    if (!thinned_) {
      const double whole = (length_ + chord) / share;
      return arcs_.size() >= most_ / 4 && whole > 0 ? pieces(double(most_) * chord / whole) : count_;
    }
    return resolution_ == 0 ? 1 : pieces(2 * chord / resolution_);
  }
  /// Adds a row at the distance `chord` from the last one. True: it replaces the row before it, which is not needed any
  /// more.
  bool add(double chord) {
    length_ += std::isfinite(chord) ? chord : 0;
    const bool replaces = arcs_.size() > 1 && arcs_.back() - arcs_[arcs_.size() - 2] < resolution_;
    if (replaces) arcs_.pop_back();
    arcs_.push_back(length_);
    return replaces;
  }
  std::size_t most() const { return most_; }
  bool full() const { return arcs_.size() >= most_; }
  /// thin returns the indices of the rows to keep: increasing, with the first and the last row.
  std::vector<std::size_t> thin() {
    thinned_ = true;
    resolution_ = 2 * (arcs_.back() - arcs_.front()) / double(most_);
    std::vector<std::size_t> kept{0};
    for (std::size_t i = 1; i + 1 < arcs_.size(); ++i) {
      const bool far = resolution_ > 0 ? arcs_[i] - arcs_[kept.back()] >= resolution_ : i % 2 == 0;
      if (far) kept.push_back(i);
    }
    if (arcs_.size() > 1) kept.push_back(arcs_.size() - 1);
    for (std::size_t i = 0; i < kept.size(); ++i) arcs_[i] = arcs_[kept[i]];
    arcs_.resize(kept.size());
    return kept;
  }
  /// choose returns the indices of `count` rows at distances as equal as the rows allow: increasing, with both ends.
  std::vector<std::size_t> choose() const {
    const std::size_t all = arcs_.size(), count = std::min(count_, all);
    std::vector<std::size_t> chosen;
    for (std::size_t k = 0, i = 0; k < count; ++k) {
      const double part = count > 1 ? double(k) / double(count - 1) : 0;
      const std::size_t last = all - (count - k);  // the rest needs one row each
      if (k == 0) {
        i = 0;
      } else if (length_ > 0) {
        const double target = part * length_;
        while (i < last && std::abs(arcs_[i + 1] - target) <= std::abs(arcs_[i] - target)) ++i;
      } else {
        i = std::max(i, static_cast<std::size_t>(part * double(all - 1)));
      }
      i = k + 1 == count ? all - 1 : std::min(i, last);
      chosen.push_back(i++);
    }
    return chosen;
  }

 private:
  std::size_t pieces(double wanted) const {
    return static_cast<std::size_t>(std::clamp(std::ceil(wanted), 1.0, double(count_)));
  }

  std::size_t count_, most_;
  double resolution_ = 0, length_ = 0;
  bool thinned_ = false;
  std::vector<double> arcs_;  ///< arc length up to each row that is kept
};

}  // namespace least
