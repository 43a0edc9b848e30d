#include "core/run/taylor_stepper.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/number/asked_by_thread.hpp"
#include "core/schemes/least_size.hpp"

namespace least {
namespace {

void copy(const StateNumbers& y, RunState& x) {
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = y[i];
}

}  // namespace

TaylorStepper::TaylorStepper(std::shared_ptr<taylor::Expansion> expansion, Completion completion)
    : expansion_(std::move(expansion)), completion_(completion), carries_(count() > moving()) {
  for (Values& one : values_) one = Values(count() + 1);
  if (!carries_) return;
  expansion_->make_beside();
  for (Mark* mark : {&mark_, &reached_, &scratch_}) mark->set(values_[0], values_[0]);
}

StepStatus TaylorStepper::step(RunState& x) noexcept { return step_within(x, std::numeric_limits<double>::infinity()); }

StepStatus TaylorStepper::step_within(RunState& x, double most, double late) noexcept {
  begin(x);
  Values &here = values(at_.end), &low = values(at_.low), &next = values(at_.from), &rest = values(at_.from_low);
  expand(here, x.t);
  work_.forces += expansion_->order();
  double h = expansion_->step(most);
  if (!(h > 0)) return StepStatus::singular;
  // If the search for switches of formulas was cut short, it is not known which formulas hold in the step.
  if (!expansion_->program().switches.empty() && !AskedByThread::goes_on()) return StepStatus::solver_failed;
  if (!(x.t + h < x.t + most)) h = most;
  for (;; h *= 0.5) {
    if (h < most && !(x.t + h > x.t)) return StepStatus::underflow;
    expansion_->evaluate(h, here.data(), low.data(), next.data(), rest.data(), true);
    // At exactly the time at which the next step begins, so that the expansion found here is reused.
    if (expansion_->defined(next.data(), x.t + (h - late))) break;
  }
  if (carries_) {
    mark_.set(here, low);
    if (!carry(x.t, h, mark_, rest, next)) return StepStatus::solver_failed;
  }
  at_ = {at_.end, at_.low, at_.from, at_.from_low, at_.start, at_.start_low};
  t_ = x.t;
  h_ = h;
  blur_ += expansion_->blur(h);
  copy(next, x);
  x.t = t_ + h;
  return StepStatus::ok;
}

StepStatus TaylorStepper::reach(RunState& x, double t) noexcept {
  constexpr int most_parts = 10'000;
  Values &y = values(at_.from), &low = values(at_.from_low);
  for (int part = 0; part < most_parts; ++part) {
    if (!(x.t < t)) return StepStatus::ok;
    read(x, y);
    std::fill(low.begin(), low.end(), 0.0);
    expand(y, x.t);
    work_.forces += expansion_->order();
    const double h = expansion_->step(t - x.t);
    if (!(h > 0)) return StepStatus::singular;
    if (!(x.t + h > x.t)) return StepStatus::underflow;
    if (carries_) reached_.set(y, low);
    expansion_->evaluate(h, low.data(), y.data(), true);
    if (carries_) carry(x.t, h, reached_, low, y);
    copy(y, x);
    x.t = h < t - x.t ? x.t + h : t;
  }
  return StepStatus::solver_failed;
}

bool TaylorStepper::interpolate(RunState& x, double t) const noexcept {
  const double h = t - t_, slack = 4 * std::numeric_limits<double>::epsilon() * std::abs(t);
  if (!(h_ > 0 && h >= 0 && h <= h_ + slack)) return false;
  Values &y = values(at_.from), &low = values(at_.from_low);
  y = values(at_.start);
  low = values(at_.start_low);
  expand(y, t_);
  expansion_->evaluate(h, low.data(), y.data(), true);
  if (carries_) {
    if (h < mark_.after) mark_.set(values(at_.start), values(at_.start_low));
    carry(t_, h, mark_, low, y);
  }
  copy(y, x);
  x.t = t;
  return true;
}

bool TaylorStepper::carry(double t, double h, Mark& mark, Values& low, Values& y) const noexcept {
  if (mark.after == 0 && !(expansion_->carried_step() < h)) return true;
  constexpr int most_parts = 1000, between_looks = 100;
  taylor::Expansion& series = expansion_->beside();
  for (int part = 0; part < most_parts; ++part) {
    if ((part + 1) % between_looks == 0 && !AskedByThread::goes_on()) {
      std::fill(y.begin() + static_cast<std::ptrdiff_t>(moving()), y.end(), std::numeric_limits<double>::quiet_NaN());
      return false;
    }
    series.move(mark.y.data(), t + mark.after);
    const double most = std::min(series.step(), series.carried_step());
    if (!(most < h - mark.after && mark.after + most > mark.after)) break;
    series.evaluate(most, mark.low.data(), mark.y.data(), true);
    mark.after += most;
  }
  scratch_.set(mark.y, mark.low);
  series.evaluate(h - mark.after, scratch_.low.data(), scratch_.y.data(), true);
  for (std::size_t i = moving(); i < count(); ++i) {
    y[i] = scratch_.y[i];
    low[i] = scratch_.low[i];
  }
  return true;
}

void TaylorStepper::expand(const Values& y, double t) const noexcept {
  if (least_size_ == 0) least_size_ = least_size(largest_of({y.begin(), moving()}));
  expansion_->set_least_size(least_size_);
  expansion_->move(y.data(), t);
}

void TaylorStepper::begin(const RunState& x) noexcept {
  Values &end = values(at_.end), &low = values(at_.low);
  const auto set = [&](std::size_t i, double value) {
    if (value == end[i]) return;
    end[i] = value;
    low[i] = 0;
  };
  if (!completion_.complete) {
    for (std::size_t i = 0; i < x.size(); ++i) set(i, x[i]);
    return;
  }
  Values& all = values(at_.from);
  read(x, all);
  for (std::size_t i = 0; i < count(); ++i) set(i, all[i]);
}

void TaylorStepper::read(const RunState& x, Values& y) const {
  for (std::size_t i = 0; i < x.size(); ++i) y[i] = x[i];
  if (completion_.complete) completion_.complete(completion_.of, x.t, y.data());
}

}  // namespace least
