// Samples that lie evenly along the curve that a run draws, whatever its steps: what a picture of it needs.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace least {

/// Which of the rows seen so far to keep, by the arc up to each, so that in the end `count` of them can be chosen at
/// nearly equal distances. Holds 32 rows for each that is asked for, a million at most (then the distances are less
/// equal), however long the curve becomes: whenever there are more, every second goes.
class CurveThinner {
 public:
  static constexpr std::size_t most_asked = 100'000;

  explicit CurveThinner(std::size_t count) : count_(count), most_(std::min<std::size_t>(32 * count, 1'000'000)) {}

  /// Into how many parts the way to the next row is to be divided, which is `chord` long and of which a part `share` of
  /// the run's time is over then (unknown where nobody knows how long it will be). Once there are rows enough for a run
  /// that ends here, the curve is taken to be as long as its way so far says: a run of many steps need not be thinned
  /// again and again.
  std::size_t parts(double chord, double share) const {
    if (!thinned_) {
      const double whole = (length_ + chord) / share;
      return arcs_.size() >= most_ / 4 && whole > 0 ? pieces(double(most_) * chord / whole) : count_;
    }
    return resolution_ == 0 ? 1 : pieces(2 * chord / resolution_);
  }
  /// True: the row before this one is not needed any more, and this one takes its place.
  bool add(double chord) {
    length_ += std::isfinite(chord) ? chord : 0;
    const bool replaces = arcs_.size() > 1 && arcs_.back() - arcs_[arcs_.size() - 2] < resolution_;
    if (replaces) arcs_.pop_back();
    arcs_.push_back(length_);
    return replaces;
  }
  std::size_t most() const { return most_; }
  bool full() const { return arcs_.size() >= most_; }
  /// The rows to keep of those there are: increasing, the first and the last among them.
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
  /// `count` of them at equal distances, as nearly as there are rows: increasing, both ends among them.
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
  std::vector<double> arcs_;  ///< of the rows that are kept
};

}  // namespace least
