// All candidate schemes at once, in search of the cheapest that is accurate enough.
#pragma once

#include <atomic>
#include <vector>

#include "core/study/pilot.hpp"
#include "core/study/search.hpp"

namespace least {

/// Contest runs one search per candidate, always that whose next run is cheapest, adaptive schemes first, until nothing
/// cheaper can come.
class Contest {
 public:
  /// accuracy 0 means that none is asked for. The contest may take `seconds`, of these `reference_seconds` for the
  /// reference solution. `known` is passed to ErrorStudy.
  Contest(const Request& scene, std::vector<SchemeConfig> candidates, double accuracy, double seconds,
          double reference_seconds, const std::atomic<bool>& cancelled, std::shared_ptr<const Conditioning> known);

  const ErrorStudy& subject() const { return subject_; }
  std::vector<Search>& searches() { return searches_; }
  double left() const { return cancelled_.load(std::memory_order_relaxed) ? 0 : deadline_.left(); }
  bool timed_out() const { return !(left() > 0); }
  /// allowance() returns how many seconds one more run may take, so that time is left for others.
  double allowance() const;

  /// begin(pilot) starts with the pilot's choice. Where there is no reference solution, a much finer run of it stands
  /// in.
  void begin(const Pilot& pilot);
  void go();
  /// find_alternatives() looks for further schemes that grant the wish at not much higher cost.
  void find_alternatives();

  /// winner() returns the search with the cheapest run that is accurate enough; null where there is none.
  const Search* winner() const;
  /// runner_up() is for the case without a winner: the search with the smallest error, or a cheaper one that is nearly
  /// as good; null where no run completed.
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
