#include "core/study/search.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace least {
namespace {

/// order returns the observed order between two runs, the first the coarser.
double order(const Probe& coarse, const Probe& fine) {
  return std::log(coarse.trial.error / fine.trial.error) / std::log(coarse.value / fine.value);
}

/// tells: whether the error predicts that of finer runs. Very coarse runs have errors as large as the motion, whatever
/// the step.
bool tells(const Trial& trial) { return trial.error < 0.3 || trial.foreseen; }

}  // namespace

Search::Search(const ErrorStudy& subject, SchemeConfig choice, double accuracy)
    : subject_(subject),
      choice_(std::move(choice)),
      dial_(subject.card(choice_)),
      accuracy_(accuracy),
      measured_(!(accuracy > 0)) {}

double Search::longest() const {
  if (!longest_) longest_ = subject_.longest(choice_, dial_);
  return *longest_;
}

double Search::seen_order(double most) const {
  if (!before_ || !bad_ || !(bad_->trial.error < before_->trial.error)) return 0;
  return std::min(order(*before_, *bad_), most);
}

double Search::least_cost() const {
  const double coarsest = bad_ ? bad_->value : longest();
  const double steps = dial_.name == "step" ? (subject_.end() - subject_.start()) / coarsest : 0;
  return bad_ ? std::max(steps, static_cast<double>(bad_->trial.forces)) : steps;
}

double Search::likely_cost() const {
  if (good_) return static_cast<double>(good_->trial.forces);
  if (!bad_ || !(bad_->trial.error < 1)) return std::numeric_limits<double>::infinity();
  const int declared = declared_order();
  return least_cost() * std::pow(bad_->trial.error / accuracy_, 1.0 / (declared > 0 ? declared : 6));
}

bool Search::out_of_reach(double error, double most) const {
  constexpr double steepest = 2, more = 12;  // times the declared order: near a change of sign errors fall far faster
  const int declared = declared_order();
  // Where a coarse run is unstable, errors of finer runs may fall at any rate.
  if (declared == 0 || good_ || !bad_ || !tells(bad_->trial) || std::isinf(most)) return false;
  return std::log(bad_->trial.error / error) > (steepest * declared + more) * std::log(most / least_cost());
}

double Search::next() const {
  constexpr double aim = 0.9;
  if (!bad_) {
    if (!good_) return longest();
    // The first run was accurate enough: coarsen by the factor that would give the accuracy if errors were proportional
    // to the dial.
    constexpr double least = 2, most = 100;
    const double ahead = good_->trial.error > 0 ? aim * accuracy_ / good_->trial.error : most;
    return std::min(good_->value * std::clamp(ahead, least, most), longest());
  }
  const double coarsest = bad_->value;
  if (good_) {
    const double ratio = coarsest / good_->value;
    double ahead = std::sqrt(ratio);
    if (bad_->trial.error < 1 && good_->trial.error > 0)
      ahead = std::pow(aim * accuracy_ / good_->trial.error, 1 / order(*bad_, *good_));
    return good_->value * std::clamp(ahead, std::pow(ratio, 0.1), std::pow(ratio, 0.9));
  }
  const double stride = dial_.adaptive() ? 10 : 2;
  if (!before_ || accuracy_ == 0 || !tells(bad_->trial) || !(bad_->trial.error < before_->trial.error))
    return coarsest / stride;
  const int declared = declared_order();
  const double seen = order(*before_, *bad_), p = declared > 0 ? std::min(seen, 1.2 * declared) : seen;
  return coarsest / std::clamp(std::pow(bad_->trial.error / (aim * accuracy_), 1 / p), 1.03, stride * stride);
}

bool Search::is_new(double value) const {
  constexpr double least_change = 1e-3;  // values that ought to be equal may differ by rounding
  return (!bad_ || value < (1 - least_change) * bad_->value) && (!good_ || value > (1 + least_change) * good_->value);
}

void Search::advance(double seconds, std::int64_t step_limit, double most) {
  double value = next();
  if (!dial_.adaptive() && bad_ && !good_ && least_cost() < most)
    value = std::max(value, bad_->value * least_cost() / most);
  if (!is_new(value)) return give_up();
  run_at(value, seconds, step_limit);
}

void Search::run_at(double value, double seconds, std::int64_t step_limit) {
  constexpr int fewest = 6;  // force evaluations per step of an adaptive scheme
  if (dial_.adaptive()) step_limit /= fewest;
  const SchemeConfig choice = dial_.at(choice_, value);
  // A search for the best run within a time has no accuracy to miss.
  const Trial trial =
      accuracy_ > 0 ? subject_.look(choice, seconds, step_limit, accuracy_) : subject_.run(choice, seconds, step_limit);
  if (trial.status == ReturnCode::deadline || trial.status == ReturnCode::cancelled) return give_up();
  settle({value, trial});
}

bool Search::measure_best(double seconds) {
  if (measured_) return false;
  measured_ = true;
  const Trial whole = subject_.run(choice(best_), seconds, most_forces);
  if (whole.status == ReturnCode::completed) best_.trial = whole;
  return true;
}

bool Search::limited_by_stability(double seconds) const {
  if (!good_ || !bad_) return false;
  const ReturnCode end = subject_.run(choice(*bad_), seconds, most_forces).status;
  return end == ReturnCode::unstable_step || end == ReturnCode::not_finite || end == ReturnCode::solver_failed;
}

void Search::settle(const Probe& probe) {
  const Trial& trial = probe.trial;
  if (trial.error < best_.trial.error || (std::isnan(best_.trial.error) && !std::isnan(trial.error))) best_ = probe;
  if (trial.error <= accuracy_) {
    good_ = probe;
  } else {
    const double last = bad_ ? bad_->trial.error : std::numeric_limits<double>::infinity();
    // If a single step spans the whole run, a finer tolerance may give the same run.
    const bool same = bad_ && trial.error == last && trial.forces == bad_->trial.forces;
    if (!good_ && !same) flat_ = trial.error > 0.9 * last && trial.error < subject_.plateau() ? flat_ + 1 : 0;
    if (bad_) before_ = bad_;
    bad_ = probe;
  }
  if (good_) {
    const double near = dial_.adaptive() ? 1.4 : 1.05;  // for tolerances, the cost follows a low power of the dial
    over_ = !(good_->value < longest()) || (bad_ && bad_->value < near * good_->value) ||
            good_->trial.error > accuracy_ / 1.2;
    return;
  }
  too_dear_ = trial.status == ReturnCode::step_limit || 1.5 * least_cost() > double(most_forces);
  over_ =
      stalled() || too_dear_ || trial.error < subject_.floor() || next() < std::max(dial_.range.low, 1e-12 * longest());
}

}  // namespace least
