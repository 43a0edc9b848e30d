// How fast small differences grow along a motion, one direction after the other.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/problem_traits.hpp"
#include "core/run/differences.hpp"
#include "core/run/landmarks.hpp"
#include "core/run/mechanics.hpp"

namespace least {

/// A start from which steps can be taken, where the equations of motion are singular at the first.
template <class P>
StateOf<P> after_series([[maybe_unused]] const P& problem, const StateOf<P>& start, [[maybe_unused]] double end) {
  if constexpr (HasSeries<P>)
    if (starts_series(problem, start) && end > P::series_until)
      return series_state<StateOf<P>>(problem, P::series_until);
  return start;
}

/// Landmarks of the true motion.
template <class P>
std::vector<PaceMark> pace_of(const P& problem, const StateOf<P>& start, double end, const KeepGoing& keep_going) {
  std::vector<PaceMark> marks;
  const auto first = after_series(problem, start, end);
  if (!(first.t < end)) return marks;
  Landmarks<StateOf<P>> landmarks{64};
  landmarks.start(first);
  Differences<P> motion(problem, first, unit<StateOf<P>::size>(0), end, 1e-9);
  for (std::size_t step = 1; motion.time() < end && motion.advance(); ++step) {
    landmarks.see(motion.state());
    if (step % 64 == 0 && !keep_going()) break;
  }
  for (const auto& [x, speed] : landmarks.list()) marks.push_back({x.t, speed});
  return marks;
}

template <class P>
class GrowthOfDifferences {
  using X = StateOf<P>;

 public:
  GrowthOfDifferences(const P& problem, X start, double end, const KeepGoing& keep_going)
      : problem_(problem), keep_going_(keep_going), from_(start.t) {
    start = after_series(problem_, start, end);
    // Where differences grow far, the motion that is followed is the true one only if it is followed closely.
    follow(start, end, 1e-9);
    if (!found_.complete || found_.most_growth * tolerance_ < 1e-2) return;
    const Conditioning known = found_;
    follow(start, end, 1e-12);
    if (!found_.complete) found_ = known;
  }

  const Conditioning& found() const { return found_; }

 private:
  static constexpr std::size_t patience = 200'000;  ///< in steps, so that the answer does not depend on the machine

  /// In all directions. Where the motion ends early, again up to shortly before that.
  void follow(const X& start, double end, double tolerance) {
    tolerance_ = tolerance;
    begin(end, false);
    for (std::size_t direction = 0; direction < X::size && found_.reached > start.t;)
      direction = from_start(start, direction) ? direction + 1 : 0;
  }
  void begin(double end, bool ends) {
    found_ = {};
    found_.variables = X::size;
    found_.reached = end;
    found_.ends = ends;
    found_.so_far.fill(1);
    if constexpr (ConstantDamping<P>) found_.damping = problem_.damping();
    if constexpr (Conservative<P>) found_.damping = 0;
  }

  /// False: the motion ends before `reached`, which is set back.
  bool from_start(const X& start, std::size_t direction) {
    if (!has_component(problem_, direction)) return true;
    Differences<P> motion(problem_, start, unit<X::size>(direction), found_.reached, tolerance_);
    look(motion, direction == 0);
    for (std::size_t step = 1; motion.time() < found_.reached && found_.complete; ++step) {
      if (!motion.advance()) {
        begin(from_ + 0.995 * (motion.time() - from_), true);
        return false;
      }
      look(motion, direction == 0);
      found_.complete = step < patience && (step % 64 != 0 || keep_going_());
    }
    found_.growth = std::max(found_.growth, motion.growth(Norm::absolute));
    found_.relative_growth = std::max(found_.relative_growth, motion.growth(Norm::relative));
    if (direction == 0)
      for (const auto& mark : landmarks_.list()) found_.pace.push_back(mark.x.t);
    return true;
  }
  void look(const Differences<P>& motion, bool first) {
    const double done = (motion.time() - from_) / (found_.reached - from_), growth = motion.growth(Norm::absolute);
    for (auto k = static_cast<std::size_t>(std::max(done * Conditioning::parts - 1e-9, 0.0)); k < Conditioning::parts;
         ++k)
      found_.so_far[k] = std::max(found_.so_far[k], growth);
    found_.most_growth = std::max(found_.most_growth, growth);
    found_.most_relative_growth = std::max(found_.most_relative_growth, motion.growth(Norm::relative));
    if (!first) return;
    const X x = motion.state();
    x.t > from_ ? landmarks_.see(x) : landmarks_.start(x);
    for (std::size_t i = 0; i < X::size; ++i) found_.size = std::max(found_.size, std::abs(x[i]));
    if (done <= 0.5) found_.size_halfway = found_.size;
    if constexpr (KeepsEnergy<P>) {
      const double level = energy(problem_, x);
      found_.energy = std::max(found_.energy, std::abs(level));
      if constexpr (Potential<P>)
        found_.energy = std::max(found_.energy, level - problem_.potential(x.q, phase(problem_, x.t)));
    }
    if constexpr (HasFrequency<P>) {
      const double here = std::sqrt(problem_.frequency_squared(position(x)));
      found_.slowest = std::fmin(found_.slowest, here);
      found_.fastest = std::fmax(found_.fastest, here);
    }
  }

  const P& problem_;
  const KeepGoing& keep_going_;
  double from_, tolerance_ = 0;
  Landmarks<X> landmarks_{48};
  Conditioning found_;
};

template <class P>
Conditioning conditioning_of(const P& problem, const StateOf<P>& start, double end, const KeepGoing& keep_going) {
  return GrowthOfDifferences<P>(problem, start, end, keep_going).found();
}

}  // namespace least
