// How fast small differences grow along a motion, one direction after the other.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/problem_traits.hpp"
#include "core/reference/tangent_motion.hpp"
#include "core/run/differences.hpp"
#include "core/run/integrator.hpp"
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
    if constexpr (IteratesForRates<P>) {
      // Where differences grow far, the motion that is followed is the true one only if it is followed closely.
      follow(start, end, 1e-9);
      if (!found_.complete || found_.most_growth * 1e-9 < 1e-2) return;
      const Conditioning known = found_;
      follow(start, end, 1e-12);
      if (!found_.complete) found_ = known;
    } else {
      follow(start, end, 1e-14);  // of series these digits cost little
    }
  }

  const Conditioning& found() const { return found_; }

 private:
  /// In steps, so that the answer does not depend on the machine.
  static constexpr std::size_t patience = IteratesForRates<P> ? 200'000 : 50'000;

  /// In all directions. Where the motion ends early, again up to shortly before that.
  void follow(const X& start, double end, double tolerance) {
    begin(end, false);
    if constexpr (IteratesForRates<P>) {
      for (std::size_t direction = 0; direction < X::size && found_.reached > start.t;)
        direction = along(start, direction, tolerance) ? direction + 1 : 0;
    } else {
      tape::Tape tape;
      const auto rates = taylor::write_equations<X>(problem_, tape);
      std::vector<std::size_t> directions;
      for (std::size_t i = 0; i < X::size; ++i)
        if (has_component(problem_, i)) directions.push_back(i);
      for (std::size_t d = 0; d < directions.size(); ++d) {
        tangents_.resize((d + 1) * X::size);
        tangents_[d * X::size + directions[d]] = 1;
      }
      TangentMotion motion(std::move(tape), rates, directions.size(), tolerance);
      while (found_.reached > start.t && !along(start, motion)) {
      }
    }
    for (const auto& mark : landmarks_.list()) found_.pace.push_back(mark.x.t);
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

  /// In one direction. False: the motion ends before `reached`, which is set back.
  bool along(const X& start, std::size_t direction, double tolerance) {
    if (!has_component(problem_, direction)) return true;
    Differences<P> motion(problem_, start, unit<X::size>(direction), found_.reached, tolerance);
    const auto seen = [&] {
      see(motion.state(), motion.growth(Norm::absolute), motion.growth(Norm::relative), direction == 0);
    };
    seen();
    for (std::size_t step = 1; motion.time() < found_.reached && found_.complete; ++step) {
      if (!motion.advance()) return ends(motion.time());
      seen();
      found_.complete = step < patience && (step % 64 != 0 || keep_going_());
    }
    found_.growth = std::max(found_.growth, motion.growth(Norm::absolute));
    found_.relative_growth = std::max(found_.relative_growth, motion.growth(Norm::relative));
    return true;
  }
  /// In all at once; within a step, which is long, the motion is seen several times.
  bool along(const X& start, TangentMotion& motion) {
    constexpr int parts = 16;
    X x = start;
    Vec<X::size> components;
    for (std::size_t i = 0; i < X::size; ++i) components[i] = start[i];
    motion.start(components, tangents_, start.t);
    double absolute = 1, relative = 1;
    const auto seen = [&](double t) {
      double size = 1e-300;  // a divisor
      for (std::size_t i = 0; i < X::size; ++i) {
        x[i] = motion.state()[i];
        size = std::max(size, std::abs(x[i]));
      }
      x.t = t;
      if (outside(problem_, x)) return false;
      absolute = motion.growth() / std::max(1.0, size);
      relative = motion.growth() / size;
      see(x, absolute, relative, true);
      return true;
    };
    seen(start.t);
    double most = std::numeric_limits<double>::infinity();  ///< of steps, at the edge of the domain
    double longest = 0;                                     ///< so far: of a motion that ends steps become shorter
    for (std::size_t step = 1; motion.time() < found_.reached && found_.complete; ++step) {
      const double from = motion.time(), left = found_.reached - from, h = std::min({motion.step(), left, most});
      if (!(h > 1e-13 * std::max(std::abs(from), longest))) return ends(from);
      const auto time = [&](int part) { return part == parts && h == left ? found_.reached : from + h * part / parts; };
      int part = 0;
      while (part < parts && motion.look(h * (part + 1) / parts) && seen(time(part + 1))) ++part;
      if (part < parts && part > 0) motion.look(h * part / parts);
      if (part == 0 || !motion.move(time(part))) {
        if (h < 1e-3 * left) return ends(from);
        most = h / parts;
        continue;
      }
      most = std::numeric_limits<double>::infinity();
      longest = std::max(longest, h);
      found_.complete = step < patience && (step % 16 != 0 || keep_going_());
    }
    found_.growth = std::max(found_.growth, absolute);
    found_.relative_growth = std::max(found_.relative_growth, relative);
    return true;
  }
  bool ends(double t) {
    begin(from_ + 0.995 * (t - from_), true);
    return false;
  }

  /// `first`: of those that see the same motion.
  void see(const X& x, double growth, double relative, bool first) {
    const double done = (x.t - from_) / (found_.reached - from_);
    for (auto k = static_cast<std::size_t>(std::max(done * Conditioning::parts - 1e-9, 0.0)); k < Conditioning::parts;
         ++k)
      found_.so_far[k] = std::max(found_.so_far[k], growth);
    found_.most_growth = std::max(found_.most_growth, growth);
    found_.most_relative_growth = std::max(found_.most_relative_growth, relative);
    if (!first) return;
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
  double from_;
  Landmarks<X> landmarks_{48};
  std::vector<double> tangents_;  ///< at the start, one direction after the other
  Conditioning found_;
};

template <class P>
Conditioning conditioning_of(const P& problem, const StateOf<P>& start, double end, const KeepGoing& keep_going) {
  return GrowthOfDifferences<P>(problem, start, end, keep_going).found();
}

}  // namespace least
