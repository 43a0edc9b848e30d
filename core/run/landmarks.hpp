// Times at which a motion should be looked at: evenly by its steps, and where it is fastest. A small error of time or
// phase is largest where the state moves fastest relative to its size: at a periapsis, before a turning point.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/run/run_state.hpp"

namespace least {

/// Landmark is a state with the speed at which it was reached: max|ẋ_i| / max(1, max|x_i|), in 1/time.
struct Landmark {
  RunState x;
  double speed = 0;
};

/// Landmarks divides the steps seen so far into stretches of equal numbers of steps, between `most`/2 and `most` of
/// them; whenever there are more, the stretches double their length. So it needs no plan of how long the motion will
/// be. It keeps the first and the fastest state of each stretch.
class Landmarks {
 public:
  Landmarks() = default;
  explicit Landmarks(std::size_t most) : most_(most) {}

  void start(const RunState& x) {
    stretches_.clear();
    stretches_.reserve(most_);
    stretches_.push_back({{x, 0}, {x, 0}});
    before_ = x;
    longest_move_ = 0;
    steps_ = 0;
    length_ = 1;
  }
  /// To be called with the state after each step, which has at least as many components as that at the start.
  void see(StateView x) {
    const double speed = speed_of(before_, x);
    longest_move_ = std::max(longest_move_, speed * (x.t - before_.t));
    before_.t = x.t;
    std::copy_n(x.numbers, before_.size(), before_.numbers.data());
    if (++steps_ % length_ == 0) {
      if (stretches_.size() == most_) join();
      if (steps_ % length_ == 0) {
        stretches_.push_back({{before_, speed}, {before_, speed}});
        return;
      }
    }
    if (speed > stretches_.back().fastest.speed) stretches_.back().fastest = {before_, speed};
  }

  std::int64_t steps() const { return steps_; }
  /// The largest change of the state in one step, relative to max(1, its size).
  double longest_move() const { return longest_move_; }
  /// All landmarks in order of time, each state once.
  std::vector<Landmark> list() const {
    std::vector<Landmark> all;
    for (const Stretch& stretch : stretches_) {
      all.push_back(stretch.first);
      if (stretch.fastest.x.t > stretch.first.x.t) all.push_back(stretch.fastest);
    }
    return all;
  }

 private:
  struct Stretch {
    Landmark first, fastest;
  };
  static double speed_of(const RunState& a, StateView b) {
    double change = 0, size = 1;
    for (std::size_t i = 0; i < a.size(); ++i) {
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
  RunState before_;
  double longest_move_ = 0;
  std::int64_t steps_ = 0, length_ = 1;
};

}  // namespace least
