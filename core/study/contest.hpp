// All candidates at once, in search of the cheapest that is accurate enough.
#pragma once

#include <atomic>
#include <vector>

#include "core/study/pilot.hpp"
#include "core/study/search.hpp"

namespace least {

/// Always the one whose next run is the cheapest, first among those that choose their steps, until nothing cheaper can
/// come.
class Contest {
 public:
  /// accuracy 0: none is asked for. May take `seconds`, of them so many to find out about the motion. `known`: of
  /// ErrorStudy.
  Contest(const Request& scene, std::vector<SchemeConfig> candidates, double accuracy, double seconds,
          double reference_seconds, const std::atomic<bool>& cancelled, std::shared_ptr<const Conditioning> known);

  const ErrorStudy& subject() const { return subject_; }
  std::vector<Search>& searches() { return searches_; }
  double left() const { return cancelled_.load(std::memory_order_relaxed) ? 0 : deadline_.left(); }
  bool timed_out() const { return !(left() > 0); }
  /// How long one more run may take, so that there is time for others.
  double allowance() const;

  /// Runs the choice of the pilot first. Where there is no truth, a much finer run of it stands in for that.
  void begin(const Pilot& pilot);
  void go();
  /// Some more that grant the wish at not much more cost.
  void find_alternatives();

  /// The search with the cheapest run that is accurate enough; null: there is none.
  const Search* winner() const;
  /// Where none is: the one with the smallest error, or one nearly as good that costs less; null: nothing completed.
  const Search* runner_up();

 private:
  void find_stand_in(const Pilot& pilot);
  double aim() const;
  double worth() const;
  std::int64_t useful_steps() const;
  bool beaten(const Search& search) const;

  const std::atomic<bool>& cancelled_;
  double seconds_;
  Deadline deadline_;
  ErrorStudy subject_;
  double accuracy_;
  std::vector<Search> searches_;
};

}  // namespace least
