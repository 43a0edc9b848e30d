// The search for the coarsest setting of one scheme that is accurate enough.
#pragma once

#include "core/study/error_study.hpp"

namespace least {

/// A run at one value of the dial.
struct Probe {
  double value = 0;
  Trial trial;
};

class Search {
 public:
  /// accuracy 0: ever finer runs, none of them good.
  Search(const ErrorStudy& subject, SchemeConfig choice, double accuracy);

  /// The run to be made next: coarse ones first, then where the order seen so far predicts the accuracy, then between
  /// the coarsest that is good and the finest that is not.
  void advance(double seconds);
  /// Nothing better will come.
  bool over() const { return over_; }
  void give_up() { over_ = true; }

  /// The cheapest run that is accurate enough.
  const std::optional<Probe>& good() const { return good_; }
  /// The finest that is not.
  const std::optional<Probe>& bad() const { return bad_; }
  /// The most accurate that completed; the error of none is NaN.
  const Probe& best() const { return best_; }
  SchemeConfig choice(const Probe& probe) const { return dial_.at(choice_, probe.value); }
  const SchemeConfig& scheme() const { return choice_; }
  const ResolutionParameter& dial() const { return dial_; }
  std::string name() const { return least::name(subject_.card(choice_), choice_); }
  int declared_order() const { return least::declared_order(subject_.card(choice_), choice_); }

  /// What a run that is accurate enough costs at least, and about, in force evaluations.
  double least_cost() const;
  double likely_cost() const;
  /// Shorter steps no longer help.
  bool stalled() const { return flat_ >= 2; }
  bool too_dear() const { return too_dear_; }
  /// What is not good enough fails, it is not inaccurate.
  bool limited_by_stability() const { return good_ && bad_ && bad_->trial.status != ReturnCode::completed; }

 private:
  double next() const;
  void settle(const Probe& probe);

  static constexpr double most_forces = 2e7;

  const ErrorStudy& subject_;
  SchemeConfig choice_;
  ResolutionParameter dial_;
  double accuracy_, longest_;
  std::optional<Probe> good_, bad_, before_;  ///< before_: the bad one before the last
  Probe best_;
  int flat_ = 0;
  bool over_ = false, too_dear_ = false;
};

}  // namespace least
