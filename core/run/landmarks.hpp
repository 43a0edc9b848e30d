// Where a motion should be looked at: evenly by its steps, and where it is fastest. A small error of time or phase is
// largest where the state moves fastest against its own size: at a periapsis, in front of a turning point.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace least {

/// A state, and the speed at which it was reached: max|ẋ_i| / max(1, max|x_i|), in 1/time.
template <class X>
struct Landmark {
  X x;
  double speed = 0;
};

/// Divides the steps seen so far into stretches of equal numbers of steps, half of `most` to `most` of them, the
/// stretch doubling whenever there are too many; so what is kept depends on where the motion got to and on no plan. Of
/// each stretch it keeps the first state and the fastest.
template <class X>
class Landmarks {
 public:
  Landmarks() = default;
  explicit Landmarks(std::size_t most) : most_(most) {}

  void start(const X& x) {
    stretches_.clear();
    stretches_.reserve(most_);
    stretches_.push_back({{x, 0}, {x, 0}});
    before_ = x;
    longest_move_ = 0;
    steps_ = 0;
    length_ = 1;
  }
  void see(const X& x) {
    const Landmark<X> here{x, speed(before_, x)};
    longest_move_ = std::max(longest_move_, here.speed * (x.t - before_.t));
    before_ = x;
    if (++steps_ % length_ == 0) {
      if (stretches_.size() == most_) join();
      if (steps_ % length_ == 0) {
        stretches_.push_back({here, here});
        return;
      }
    }
    if (here.speed > stretches_.back().fastest.speed) stretches_.back().fastest = here;
  }

  std::int64_t steps() const { return steps_; }
  /// By how much of its size, or of 1, the state changed in a step at most.
  double longest_move() const { return longest_move_; }
  /// In the order of their times, each state once.
  std::vector<Landmark<X>> list() const {
    std::vector<Landmark<X>> all;
    for (const Stretch& stretch : stretches_) {
      all.push_back(stretch.first);
      if (stretch.fastest.x.t > stretch.first.x.t) all.push_back(stretch.fastest);
    }
    return all;
  }

 private:
  struct Stretch {
    Landmark<X> first, fastest;
  };
  static double speed(const X& a, const X& b) {
    double change = 0, size = 1;
    for (std::size_t i = 0; i < X::size; ++i) {
      change = std::max(change, std::abs(b[i] - a[i]));
      size = std::max(size, std::abs(b[i]));
    }
    return change / (size * (b.t - a.t));
  }
  void join() {
    for (std::size_t i = 0; 2 * i < stretches_.size(); ++i) {
      const Stretch& left = stretches_[2 * i];
      const Stretch& right = stretches_[std::min(2 * i + 1, stretches_.size() - 1)];
      stretches_[i] = {left.first, left.fastest.speed < right.fastest.speed ? right.fastest : left.fastest};
    }
    stretches_.resize((stretches_.size() + 1) / 2);
    length_ *= 2;
  }

  std::size_t most_ = 128;
  std::vector<Stretch> stretches_;
  X before_{};
  double longest_move_ = 0;
  std::int64_t steps_ = 0, length_ = 1;
};

}  // namespace least
