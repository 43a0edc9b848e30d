// The search for the coarsest setting of one scheme that is accurate enough.
#pragma once

#include "core/study/error_study.hpp"

namespace least {

/// Probe is a run at one value of the dial.
struct Probe {
  double value = 0;
  Trial trial;
};

/// Search looks for the coarsest sufficiently accurate dial of one SchemeConfig.
class Search {
 public:
  /// accuracy 0: ever finer runs, none of which counts as good.
  Search(const ErrorStudy& subject, SchemeConfig choice, double accuracy);

  /// advance makes the next run: coarse ones first, then where the observed order predicts the accuracy, then between
  /// the coarsest good and the finest bad one. A run may take so many seconds and steps; one that needs more is too
  /// dear. As long as none is good, a run with fixed steps costs about `most` force evaluations at most.
  void advance(double seconds, std::int64_t step_limit, double most);
  /// begin_at makes a first run where the accuracy is expected, instead of coarse ones.
  void begin_at(double value, double seconds, std::int64_t step_limit) { run_at(value, seconds, step_limit); }
  /// over() tells that nothing better will come.
  bool over() const { return over_; }
  void give_up() { over_ = true; }

  /// The cheapest run that is accurate enough.
  const std::optional<Probe>& good() const { return good_; }
  /// The finest run that is not.
  const std::optional<Probe>& bad() const { return bad_; }
  /// The most accurate completed run; its error is NaN if there is none. The error of a run that is not good may be
  /// known at few times only.
  const Probe& best() const { return best_; }
  /// measure_best measures that run along the whole span, within `seconds`. Returns false if that has been tried
  /// before.
  bool measure_best(double seconds);
  SchemeConfig choice(const Probe& probe) const { return dial_.at(choice_, probe.value); }
  const SchemeConfig& scheme() const { return choice_; }
  const ResolutionParameter& dial() const { return dial_; }
  std::string name() const { return least::name(subject_.card(choice_), choice_); }
  int declared_order() const { return least::declared_order(subject_.card(choice_), choice_); }
  /// seen_order returns the observed order of the last two runs, at most `most`; under a weak perturbation it exceeds
  /// the declared one.
  double seen_order(double most) const;
  /// twin_of tells whether two searches vary the tolerance of the same scheme: only one of them is reported, whatever
  /// their other settings.
  bool twin_of(const Search& other) const { return choice_.scheme == other.choice_.scheme && dial_.adaptive(); }

  /// Lower bound and estimate of the force evaluations of a run that is accurate enough.
  double least_cost() const;
  double likely_cost() const;
  /// out_of_reach tells that no run with a cost below `most` has so small an error: the error would have to fall faster
  /// than was ever observed.
  bool out_of_reach(double error, double most) const;
  /// stalled(): shorter steps no longer help.
  bool stalled() const { return flat_ >= 2; }
  bool too_dear() const { return too_dear_; }
  /// limited_by_stability tells whether the bad run fails for instability, not for inaccuracy, whatever time it is
  /// given.
  bool limited_by_stability(double seconds) const;

  static constexpr std::int64_t most_forces = 20'000'000;

 private:
  double longest() const;
  double next() const;
  /// is_new tells whether a run at this value would add information.
  bool is_new(double value) const;
  void run_at(double value, double seconds, std::int64_t step_limit);
  void settle(const Probe& probe);

  const ErrorStudy& subject_;
  SchemeConfig choice_;
  ResolutionParameter dial_;
  double accuracy_;
  mutable std::optional<double> longest_;     ///< computed when first needed, as it may take a step
  std::optional<Probe> good_, bad_, before_;  ///< before_: the bad one before bad_
  Probe best_;
  bool measured_;  ///< best_ is measured along the whole span
  int flat_ = 0;
  bool over_ = false, too_dear_ = false;
};

}  // namespace least
