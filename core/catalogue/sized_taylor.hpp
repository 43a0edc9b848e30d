// taylor on a scene whose size is known when it runs: the stepper of core/schemes/taylor.hpp on components that stand
// one after the other.
#pragma once

#include <limits>
#include <memory>
#include <vector>

#include "core/number/asked_by_thread.hpp"
#include "core/run/run_state.hpp"
#include "core/schemes/taylor.hpp"
#include "core/text/sized_scene.hpp"

namespace least {

class SizedTaylorStepper {
 public:
  static constexpr bool reads_time = true, has_dense = true;
  static constexpr int parts = 16;

  /// Of the motion of a scene, which outlives it.
  SizedTaylorStepper(const text::SizedScene& scene, std::shared_ptr<taylor::Expansion> expansion)
      : scene_(&scene),
        expansion_(std::move(expansion)),
        start_(expansion_->program().variables),
        end_(start_),
        start_low_(start_),
        low_(start_) {}

  StepStatus step(RunState& x) noexcept { return step_within(x, std::numeric_limits<double>::infinity()); }
  /// As that of TaylorStepper.
  StepStatus step_within(RunState& x, double most, double late = 0) noexcept {
    begin(x);
    expansion_->move(end_.data(), x.t);
    from_ = end_;
    from_low_ = low_;
    work_.forces += expansion_->order();
    double h = expansion_->step(most);
    if (!(h > 0)) return StepStatus::singular;
    // Of a step that was not looked at to its end it is not known which formulas hold in it.
    if (!expansion_->program().switches.empty() && !AskedByThread::goes_on()) return StepStatus::solver_failed;
    if (!(x.t + h < x.t + most)) h = most;
    for (;; h *= 0.5) {
      if (h < most && !(x.t + h > x.t)) return StepStatus::underflow;
      expansion_->evaluate(h, from_.data(), from_low_.data(), end_.data(), low_.data());
      if (expansion_->defined(end_.data(), x.t + (h - late))) break;
    }
    std::swap(start_, from_);
    std::swap(start_low_, from_low_);
    t_ = x.t;
    h_ = h;
    std::copy_n(end_.begin(), x.size(), x.numbers.begin());
    x.t = t_ + h;
    return StepStatus::ok;
  }
  double elapsed() const { return h_; }

  /// x moved to the time t, not before its own, by as many steps as that takes.
  StepStatus reach(RunState& x, double t) noexcept {
    constexpr int most_parts = 10'000;
    for (int part = 0; part < most_parts; ++part) {
      if (!(x.t < t)) return StepStatus::ok;
      complete(x);
      from_low_.assign(from_.size(), 0);
      expansion_->move(from_.data(), x.t);
      work_.forces += expansion_->order();
      const double h = expansion_->step(t - x.t);
      if (!(h > 0)) return StepStatus::singular;
      if (!(x.t + h > x.t)) return StepStatus::underflow;
      expansion_->evaluate(h, from_low_.data(), from_.data());
      std::copy_n(from_.begin(), x.size(), x.numbers.begin());
      x.t = h < t - x.t ? x.t + h : t;
    }
    return StepStatus::solver_failed;
  }
  /// x set to the state at t by the polynomial of the last step; false where t lies outside it.
  bool interpolate(RunState& x, double t) const noexcept {
    const double h = t - t_, slack = 4 * std::numeric_limits<double>::epsilon() * std::abs(t);
    if (!(h_ > 0 && h >= 0 && h <= h_ + slack)) return false;
    from_ = start_;
    from_low_ = start_low_;
    expansion_->move(from_.data(), t_);
    expansion_->evaluate(h, from_low_.data(), from_.data());
    std::copy_n(from_.begin(), x.size(), x.numbers.begin());
    x.t = t;
    return true;
  }
  const Work& work() const noexcept { return work_; }
  /// One that has taken no step yet, of the same program.
  SizedTaylorStepper anew() const { return {*scene_, expansion_}; }

 private:
  /// Where a step begins: where the last one ended, with what rounding has kept from it, but for what is changed.
  void begin(const RunState& x) {
    complete(x);
    for (std::size_t i = 0; i < end_.size(); ++i)
      if (from_[i] != end_[i]) {
        end_[i] = from_[i];
        low_[i] = 0;
      }
  }
  /// The variables of the series at a state, in from_.
  void complete(const RunState& x) {
    std::copy_n(x.numbers.begin(), x.size(), from_.begin());
    scene_->find_velocities(from_.data(), x.t);
  }

  const text::SizedScene* scene_;
  std::shared_ptr<taylor::Expansion> expansion_;
  double t_ = 0, h_ = 0;                                       ///< of the last step
  std::vector<double> start_, end_, start_low_, low_;          ///< where it began and ended; what rounding has kept
  mutable std::vector<double> from_{start_}, from_low_{low_};  ///< scratch
  Work work_;
};

}  // namespace least
