#include "core/run/taylor_stepper.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/number/asked_by_thread.hpp"

namespace least {
namespace {

void copy(const std::vector<double>& y, RunState& x) {
  double* const numbers = x.numbers.data();
  for (std::size_t i = 0; i < x.size(); ++i) numbers[i] = y[i];
}

}  // namespace

TaylorStepper::TaylorStepper(std::shared_ptr<taylor::Expansion> expansion, Completion completion)
    : expansion_(std::move(expansion)), completion_(completion), carries_(count() > moving()) {
  // With room for a whole four where three stand behind others.
  for (Values* all : {&start_, &end_, &start_low_, &low_, &from_, &from_low_}) all->resize(count() + 1);
  if (!carries_) return;
  expansion_->make_beside();
  for (Values* all : {&mark_.y, &mark_.low, &mark_end_, &mark_rest_}) all->resize(count() + 1);
}

StepStatus TaylorStepper::step(RunState& x) noexcept { return step_within(x, std::numeric_limits<double>::infinity()); }

StepStatus TaylorStepper::step_within(RunState& x, double most, double late) noexcept {
  begin(x);
  expansion_->move(end_.data(), x.t);
  work_.forces += expansion_->order();
  double h = expansion_->step(most);
  if (!(h > 0)) return StepStatus::singular;
  // Of a step that was not looked at to its end it is not known which formulas hold in it.
  if (!expansion_->program().switches.empty() && !AskedByThread::goes_on()) return StepStatus::solver_failed;
  if (!(x.t + h < x.t + most)) h = most;
  for (;; h *= 0.5) {
    if (h < most && !(x.t + h > x.t)) return StepStatus::underflow;
    expansion_->evaluate(h, end_.data(), low_.data(), from_.data(), from_low_.data(), true);
    // At the very time that the next step begins at: what is found here need not be found again.
    if (expansion_->defined(from_.data(), x.t + (h - late))) break;
  }
  if (carries_) {
    mark_ = {0, end_, low_};
    carry(x.t, h, mark_, from_low_, from_);
  }
  start_.swap(end_);
  start_low_.swap(low_);
  end_.swap(from_);
  low_.swap(from_low_);
  t_ = x.t;
  h_ = h;
  copy(end_, x);
  x.t = t_ + h;
  return StepStatus::ok;
}

StepStatus TaylorStepper::reach(RunState& x, double t) noexcept {
  constexpr int most_parts = 10'000;
  Mark mark;
  for (int part = 0; part < most_parts; ++part) {
    if (!(x.t < t)) return StepStatus::ok;
    read(x, from_);
    std::fill(from_low_.begin(), from_low_.end(), 0.0);
    expansion_->move(from_.data(), x.t);
    work_.forces += expansion_->order();
    const double h = expansion_->step(t - x.t);
    if (!(h > 0)) return StepStatus::singular;
    if (!(x.t + h > x.t)) return StepStatus::underflow;
    if (carries_) mark = {0, from_, from_low_};
    expansion_->evaluate(h, from_low_.data(), from_.data(), true);
    if (carries_) carry(x.t, h, mark, from_low_, from_);
    copy(from_, x);
    x.t = h < t - x.t ? x.t + h : t;
  }
  return StepStatus::solver_failed;
}

bool TaylorStepper::interpolate(RunState& x, double t) const noexcept {
  const double h = t - t_, slack = 4 * std::numeric_limits<double>::epsilon() * std::abs(t);
  if (!(h_ > 0 && h >= 0 && h <= h_ + slack)) return false;
  from_ = start_;
  from_low_ = start_low_;
  expansion_->move(from_.data(), t_);
  expansion_->evaluate(h, from_low_.data(), from_.data(), true);
  if (carries_) {
    if (h < mark_.after) mark_ = {0, start_, start_low_};
    carry(t_, h, mark_, from_low_, from_);
  }
  copy(from_, x);
  x.t = t;
  return true;
}

void TaylorStepper::carry(double t, double h, Mark& mark, Values& low, Values& y) const noexcept {
  if (mark.after == 0 && !(expansion_->carried_step() < h)) return;
  constexpr int most_parts = 1000;
  taylor::Expansion& series = expansion_->beside();
  for (int part = 0; part < most_parts; ++part) {
    series.move(mark.y.data(), t + mark.after);
    const double most = std::min(series.step(), series.carried_step());
    if (!(most < h - mark.after && mark.after + most > mark.after)) break;
    series.evaluate(most, mark.low.data(), mark.y.data(), true);
    mark.after += most;
  }
  mark_end_ = mark.y;
  mark_rest_ = mark.low;
  series.evaluate(h - mark.after, mark_rest_.data(), mark_end_.data(), true);
  for (std::size_t i = moving(); i < count(); ++i) {
    y[i] = mark_end_[i];
    low[i] = mark_rest_[i];
  }
}

void TaylorStepper::begin(const RunState& x) noexcept {
  const auto set = [this](std::size_t i, double value) {
    if (value == end_[i]) return;
    end_[i] = value;
    low_[i] = 0;
  };
  if (!completion_.complete) {
    for (std::size_t i = 0; i < x.size(); ++i) set(i, x[i]);
    return;
  }
  read(x, from_);
  for (std::size_t i = 0; i < count(); ++i) set(i, from_[i]);
}

void TaylorStepper::read(const RunState& x, Values& y) const {
  for (std::size_t i = 0; i < x.size(); ++i) y[i] = x[i];
  if (completion_.complete) completion_.complete(completion_.of, x.t, y.data());
}

}  // namespace least
