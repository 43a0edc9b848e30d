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
  /// the coarsest that is good and the finest that is not. At most so long, and of at most so many steps: one that
  /// takes more is too dear. As long as none is good, one of equal steps costs no more than about `most`.
  void advance(double seconds, std::int64_t step_limit, double most);
  /// A first run near where the accuracy is expected, instead of coarse ones.
  void begin_at(double value, double seconds, std::int64_t step_limit) { run_at(value, seconds, step_limit); }
  /// Nothing better will come.
  bool over() const { return over_; }
  void give_up() { over_ = true; }

  /// The cheapest run that is accurate enough.
  const std::optional<Probe>& good() const { return good_; }
  /// The finest that is not.
  const std::optional<Probe>& bad() const { return bad_; }
  /// The most accurate that completed; the error of none is NaN. One that is not good may be known at few times only.
  const Probe& best() const { return best_; }
  /// Makes it known along the span, if there is time; true where that had not been tried.
  bool measure_best(double seconds);
  SchemeConfig choice(const Probe& probe) const { return dial_.at(choice_, probe.value); }
  const SchemeConfig& scheme() const { return choice_; }
  const ResolutionParameter& dial() const { return dial_; }
  std::string name() const { return least::name(subject_.card(choice_), choice_); }
  int declared_order() const { return least::declared_order(subject_.card(choice_), choice_); }
  /// That of its last two runs, at most `most`: of a weak perturbation it is higher than what is declared.
  double seen_order(double most) const;
  /// One of the same scheme by its tolerance: however it chooses the rest, there is one to be told of.
  bool twin_of(const Search& other) const { return choice_.scheme == other.choice_.scheme && dial_.adaptive(); }

  /// What a run that is accurate enough costs at least, and about, in force evaluations.
  double least_cost() const;
  double likely_cost() const;
  /// Whether nothing that costs less than `most` has so small an error: it would have to fall faster than ever seen.
  bool out_of_reach(double error, double most) const;
  /// Shorter steps no longer help.
  bool stalled() const { return flat_ >= 2; }
  bool too_dear() const { return too_dear_; }
  /// What is not good enough comes to no number, whatever time it is given: it is not inaccurate.
  bool limited_by_stability(double seconds) const;

  static constexpr std::int64_t most_forces = 20'000'000;

 private:
  double longest() const;
  double next() const;
  /// Whether a run at this value may say what those made so far do not.
  bool is_new(double value) const;
  void run_at(double value, double seconds, std::int64_t step_limit);
  void settle(const Probe& probe);

  const ErrorStudy& subject_;
  SchemeConfig choice_;
  ResolutionParameter dial_;
  double accuracy_;
  mutable std::optional<double> longest_;     ///< known once it is asked for: it may take a step to find
  std::optional<Probe> good_, bad_, before_;  ///< before_: the bad one before the last
  Probe best_;
  bool measured_;  ///< best_ is known along the span
  int flat_ = 0;
  bool over_ = false, too_dear_ = false;
};

}  // namespace least
