#include "core/variations/varied_run.hpp"

#include <algorithm>

#include "core/catalogue/catalogue.hpp"

namespace least::variations {
namespace {

constexpr std::size_t time_column = 0;  // the time is the first column of every card

/// TimedRows passes rows on without their last column, the time, which it collects in `times`.
class TimedRows final : public RowSink {
 public:
  TimedRows(RowSink& sink, std::size_t columns, std::size_t time, std::vector<double>& times)
      : sink_(sink), columns_(columns), time_(time), times_(times) {}

  bool append(std::span<const double> rows) override {
    for (std::size_t at = 0; at < rows.size(); at += columns_) times_.push_back(rows[at + time_]);
    if (time_ + 1 < columns_ || !added_) return sink_.append(rows);
    asked_for_.clear();
    for (std::size_t at = 0; at < rows.size(); at += columns_)
      asked_for_.insert(asked_for_.end(), rows.begin() + static_cast<std::ptrdiff_t>(at),
                        rows.begin() + static_cast<std::ptrdiff_t>(at + columns_ - 1));
    return sink_.append(asked_for_);
  }
  bool append_section(std::span<const double> rows) override { return sink_.append_section(rows); }
  bool progress(double t, std::int64_t steps) override { return sink_.progress(t, steps); }
  void take_off_the_last() { added_ = true; }

 private:
  RowSink& sink_;
  std::size_t columns_, time_;
  bool added_ = false;
  std::vector<double>& times_;
  std::vector<double> asked_for_;
};

}  // namespace

VariedRun::VariedRun(Request request, std::shared_ptr<const SensitivitiesAsked> asked)
    : request_(std::move(request)), asked_(std::move(asked)) {}

Solution VariedRun::go(RowSink& sink, const std::atomic<bool>& cancelled) {
  const Mechanics& mechanics = *request_.scene->mechanics;
  if (!asked_->at_samples) return mechanics.run(request_, sink, cancelled);
  Request timed = request_;
  const auto known = std::ranges::find(timed.columns, time_column);
  const auto place = static_cast<std::size_t>(known - timed.columns.begin());
  const bool added = known == timed.columns.end();
  if (added) {
    timed.columns.push_back(time_column);
    timed.uncounted = 1;
  }
  TimedRows rows(sink, timed.columns.size(), place, times_);
  if (added) rows.take_off_the_last();
  return mechanics.run(timed, rows, cancelled);
}

Sensitivities VariedRun::sensitivities(const Solution& outcome, const std::atomic<bool>& cancelled) const {
  const std::chrono::duration<double> limit(request_.limits.seconds);
  const KeepGoing keep_going = [&] { return !cancelled && Clock::now() - began_ < limit; };
  const std::size_t rows = asked_->equations->components, numbers = times_.size() * rows * asked_->by.size();
  if (numbers > static_cast<std::size_t>(request_.limits.samples)) {
    Sensitivities none;
    for (const std::size_t place : asked_->equations->variables)
      none.rows.push_back(request_.scene->card().variables[place].name);
    none.reason = "at samples they would be " + std::to_string(numbers) + " numbers, more than limits.samples";
    return none;
  }
  if (asked_->of_scheme) return sensitivities_of_scheme(request_, *asked_, outcome, times_, keep_going);
  constexpr double close = 1e-12;
  const SchemeCard& scheme = schemes()[request_.scheme];
  const bool by_series = scheme.id == "taylor";
  return sensitivities_of_motion(request_, *asked_, outcome, times_,
                                 by_series ? request_.setting("tolerance", scheme) : close, keep_going);
}

}  // namespace least::variations
