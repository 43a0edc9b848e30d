#include "core/study/contest.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace least {
namespace {

/// Between the times at which runs are compared with the reference, errors may be somewhat larger.
constexpr double margin = 0.87;

}  // namespace

Contest::Contest(const Request& scene, std::vector<SchemeConfig> candidates, double accuracy, double seconds,
                 double reference_seconds, const std::atomic<bool>& cancelled,
                 std::shared_ptr<const Conditioning> known)
    : cancelled_(cancelled),
      seconds_(seconds),
      deadline_(seconds),
      subject_(scene, false, reference_seconds, cancelled, std::move(known)),
      accuracy_(margin * accuracy) {
  subject_.end_with(deadline_);
  for (SchemeConfig& choice : candidates) searches_.emplace_back(subject_, std::move(choice), accuracy_);
}

double Contest::allowance() const {
  constexpr double share = 0.1, slower = 20;
  const Search* best = winner();
  const double most = best ? std::max(share * seconds_, slower * best->good()->trial.seconds) : left() / 4;
  return std::min(most, left());
}

const Search* Contest::winner() const {
  const Search* best = nullptr;
  for (const Search& search : searches_)
    if (search.good() && (!best || search.likely_cost() < best->likely_cost())) best = &search;
  return best;
}

const Search* Contest::runner_up() {
  constexpr double near = 1.5;
  double least_error = 0;
  do {  // errors at few times may miss the largest
    least_error = std::numeric_limits<double>::infinity();
    for (const Search& search : searches_) least_error = std::fmin(least_error, search.best().trial.error);
  } while (std::ranges::any_of(searches_, [&](Search& search) {
    return search.best().trial.error <= near * least_error && search.measure_best(left());
  }));
  const Search* best = nullptr;
  for (const Search& search : searches_)
    if (search.best().trial.error <= near * least_error &&
        (!best || search.best().trial.forces < best->best().trial.forces))
      best = &search;
  return best;
}

void Contest::begin(const Pilot& pilot) {
  if (!pilot.completed) return;
  if (!subject_.known()) find_stand_in(pilot);
  for (Search& search : searches_)
    if (search.scheme().scheme == pilot.choice->scheme) {
      const double value = search.dial().value(*pilot.choice);
      if (search.dial().at(search.scheme(), value).settings == pilot.choice->settings)
        search.begin_at(value, left() / 2, Search::most_forces);
    }
}

void Contest::find_stand_in(const Pilot& pilot) {
  constexpr double finer = 1000, share = 0.3;
  const double tolerance = subject_.dial(*pilot.choice).value(*pilot.choice) / finer;
  // First another scheme: where two schemes that share nothing agree, both are right.
  for (const SchemeConfig& choice : pilot.others)
    if (!subject_.has_stand_in()) subject_.let_stand_in(subject_.dial(choice).at(choice, tolerance), share * left());
  if (!subject_.has_stand_in())
    subject_.let_stand_in(subject_.dial(*pilot.choice).at(*pilot.choice, tolerance), share * left());
}

void Contest::go() {
  // Adaptive schemes come near the accuracy in few runs, and their cost limits how far the others need to go. If that
  // takes more than half of the time, the others have their turn.
  const double half = left() / 2;
  while (!timed_out()) {
    const double most = worth();
    const bool adaptive_first = left() > half;
    Search* next = nullptr;
    for (Search& search : searches_) {
      if (!winner() && beaten(search)) search.give_up();
      if (search.over() || !(search.least_cost() < most) || search.out_of_reach(aim(), most)) continue;
      const auto later = [&](const Search& one) {
        return std::pair(adaptive_first && !one.dial().adaptive(), one.least_cost());
      };
      if (!next || later(search) < later(*next)) next = &search;
    }
    if (!next) return;
    next->advance(allowance(), useful_steps(), most);
  }
}

void Contest::find_alternatives() {
  constexpr int enough = 3, most_runs = 16;
  const Search* best = winner();
  const double most = 4 * std::max(best->likely_cost(), 10.0);
  // Reported already, as the best or as an earlier search of the same scheme
  const auto told = [&](const Search& search) {
    return std::ranges::any_of(searches_, [&](const Search& other) {
      return (&other == best || (other.good() && &other < &search)) && search.twin_of(other);
    });
  };
  const auto found = [&] {
    return std::ranges::count_if(
        searches_, [&](const Search& search) { return search.good() && &search != best && !told(search); });
  };
  for (int run = 0; run < most_runs && found() < enough && !timed_out(); ++run) {
    Search* next = nullptr;
    for (Search& search : searches_)
      if (!search.over() && !search.good() && !told(search) &&
          search.likely_cost() < (next ? next->likely_cost() : most))
        next = &search;
    if (!next) return;
    next->advance(allowance(), useful_steps(), std::numeric_limits<double>::infinity());
  }
}

/// aim(): errors below the floor are meaningless, and those of long runs end somewhat above it. Where the accuracy is
/// below the floor, this is about as accurate as runs get.
double Contest::aim() const {
  constexpr double above = 10;
  return subject_.floor() > accuracy_ ? above * subject_.floor() : accuracy_;
}

/// worth() returns the cost that a run has to stay below to be of interest.
double Contest::worth() const {
  constexpr double less = 1.05, more = 1.1;
  if (const Search* best = winner()) return best->likely_cost() / less;
  double most = std::numeric_limits<double>::infinity();
  for (const Search& search : searches_)
    if (search.best().trial.error <= aim()) most = std::fmin(most, static_cast<double>(search.best().trial.forces));
  return more * most;  // includes runs that are more accurate at little more cost
}

/// useful_steps(): a longer run has no advantage over the best one.
std::int64_t Contest::useful_steps() const {
  const Search* best = winner();
  return best ? std::min<std::int64_t>(1000 + 8 * best->good()->trial.forces, Search::most_forces)
              : Search::most_forces;
}

/// beaten tells whether a finished search was more accurate at much lower cost.
bool Contest::beaten(const Search& search) const {
  return std::ranges::any_of(searches_, [&](const Search& other) {
    return other.over() && !search.over() && search.bad() && other.best().trial.error < search.bad()->trial.error &&
           static_cast<double>(other.best().trial.forces) < search.least_cost() / 4;
  });
}

}  // namespace least
