#include "core/ensemble/ensemble.hpp"

#include <algorithm>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <thread>

#include "core/clock.hpp"
#include "core/ensemble/lane_members.hpp"
#include "core/ensemble/lone_members.hpp"
#include "core/ensemble/members_at_poles.hpp"
#include "core/run/save_schedule.hpp"
#include "core/run/section_times.hpp"

namespace least {
namespace {

/// sum_up computes the statistics of a block from its final states.
void sum_up(const EnsemblePlan& plan, Harvest& harvest) {
  const std::size_t columns = plan.request.columns.size();
  std::vector<double> values(harvest.final_member.size());
  const auto column = [&](std::size_t k) -> const std::vector<double>& {
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = harvest.final[i * columns + k];
    return values;
  };
  for (std::size_t k = 0; plan.statistics && k < columns; ++k) harvest.columns.push_back(Moments::of(column(k)));
  for (const HistogramAsked& asked : plan.histograms) {
    Histogram& histogram = harvest.histograms.emplace_back();
    histogram.counts.resize(static_cast<std::size_t>(asked.bins));  // also where no member of the block completed
    for (const double x : column(asked.column)) histogram.count(asked, x);
  }
  if (plan.final) return;
  harvest.final.clear();
  harvest.final_member.clear();
}

}  // namespace

std::int64_t first_block(const EnsemblePlan& plan, const Shard& shard) {
  const std::int64_t first = plan.first_block();
  return first + (shard.index - first % shard.of + shard.of) % shard.of;
}

namespace {

/// Blocks distributes blocks to threads, and passes them to the receiver in order.
class Blocks {
 public:
  Blocks(const EnsemblePlan& plan, const Shard& shard, unsigned threads, const std::atomic<bool>& cancelled,
         const Share& share, MemoryBudget* memory)
      : plan_(plan),
        columns_(plan.request, plan.members.vary),
        shard_(shard),
        ahead_(std::int64_t{threads} * (plan.request.section || plan.final || plan.trajectories ? 1 : 4) + 1),
        cancelled_(cancelled),
        share_(share),
        memory_(memory) {
    next_ = awaited_ = first_block(plan, shard);
    threads_.reserve(threads);
    for (unsigned i = 0; i < threads; ++i) {
      try {
        threads_.emplace_back([this, i] { work(i); });
      } catch (const std::exception&) {  // no memory or no right to one more: fewer threads have to do
        if (threads_.empty()) throw;
        break;
      }
    }
  }
  ~Blocks() {
    end(ReturnCode::cancelled);
    for (auto& thread : threads_) thread.join();
  }
  Blocks(const Blocks&) = delete;
  Blocks& operator=(const Blocks&) = delete;

  /// take() returns the next block; nothing at the end, and then `reason` says why it ended.
  std::optional<Block> take() {
    std::unique_lock lock(mutex_);
    for (unsigned working = 0;;) {
      if (failure_) std::rethrow_exception(failure_);
      if (awaited_ >= plan_.end_block()) return std::nullopt;  // complete, however late it is by now
      const unsigned share = share_ ? share_() : 0;
      if (share != working) changed_.notify_all();
      working = share;
      if (cancelled_.load(std::memory_order_relaxed)) end_locked(ReturnCode::cancelled);
      if (read_clock() - began_ > plan_.request.limits.seconds) end_locked(ReturnCode::deadline);
      if (reason_ != ReturnCode::completed) return std::nullopt;
      if (const auto found = done_.find(awaited_); found != done_.end()) {
        Block block = std::move(found->second);
        done_.erase(found);
        awaited_ += shard_.of;
        changed_.notify_all();
        return block;
      }
      changed_.wait_for(lock, std::chrono::milliseconds(20));
    }
  }
  ReturnCode reason() const { return reason_; }

 private:
  void end_locked(ReturnCode reason) {
    if (reason_ == ReturnCode::completed) reason_ = reason;
    stop_ = true;
    changed_.notify_all();
  }
  void end(ReturnCode reason) {
    const std::lock_guard lock(mutex_);
    end_locked(reason);
  }

  void work(unsigned thread) {
    const HeldByThread held(memory_);
    try {
      while (const auto index = claim(thread)) {
        std::optional<Block> block;
        try {
          block = compute(*index);
        } catch (const MemoryShortage&) {  // with fewer blocks at once there may be room
        }
        const std::lock_guard lock(mutex_);
        --computing_;
        if (stop_) return;
        if (block) done_.emplace(*index, std::move(*block));
        if (!block) put_off(*index);
        changed_.notify_all();
      }
    } catch (...) {
      const std::lock_guard lock(mutex_);
      failure_ = std::current_exception();
      changed_.notify_all();
    }
  }
  /// claim returns the next block to compute. No thread runs far ahead of what was received, so that memory does not
  /// grow with the number of members.
  std::optional<std::int64_t> claim(unsigned thread) {
    std::unique_lock lock(mutex_);
    const auto next = [&] { return again_.empty() ? next_ : std::min(next_, *again_.begin()); };
    const auto over = [&] { return stop_ || next() >= plan_.end_block(); };
    const auto may = [&] { return !share_ || thread < share_(); };
    changed_.wait(lock, [&] { return over() || (may() && next() - awaited_ < ahead_ * shard_.of); });
    if (over()) return std::nullopt;
    ++computing_;
    const std::int64_t index = next();
    if (again_.erase(index) == 0) next_ += shard_.of;
    return index;
  }
  /// put_off repeats a block that found no memory later, and from now on one block at a time, so that only it and the
  /// received blocks hold memory. If that was already so, the memory does not suffice.
  void put_off(std::int64_t index) {
    if (index == awaited_ && computing_ == 0 && done_.empty()) return end_locked(ReturnCode::memory);
    ahead_ = 1;
    again_.insert(index);
    for (auto entry = done_.upper_bound(awaited_); entry != done_.end(); entry = done_.erase(entry))
      again_.insert(entry->first);
  }
  Block compute(std::int64_t index) const {
    Block block;
    block.index = index;
    block.first = std::max(plan_.first, index * block_size);
    block.count = std::min(plan_.last, (index + 1) * block_size) - block.first;
    block.held = Held(memory_);
    for (const HistogramAsked& asked : plan_.histograms)
      block.held.add(sizeof(std::int64_t) * static_cast<std::size_t>(asked.bins));
    if (any_meets_pole(plan_, block) || !run_lane_members(plan_, columns_, block, stop_))
      run_lone_members(plan_, columns_, block, stop_);
    if (!stop_) sum_up(plan_, block.harvest);
    return block;
  }

  const EnsemblePlan& plan_;
  const MemberColumns columns_;
  const Shard shard_;
  std::int64_t ahead_;  ///< how many blocks threads may be ahead of the receiver
  std::atomic<bool> stop_{false};
  const double began_ = read_clock();
  const std::atomic<bool>& cancelled_;
  const Share& share_;
  MemoryBudget* const memory_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::int64_t next_ = 0, awaited_ = 0;
  int computing_ = 0;  ///< blocks being computed
  std::map<std::int64_t, Block> done_;
  std::set<std::int64_t> again_;  ///< blocks to repeat, as there was no memory for them
  ReturnCode reason_ = ReturnCode::completed;
  std::exception_ptr failure_;
  std::vector<std::thread> threads_;
};

}  // namespace

std::string ensemble_objection(const SchemeCard& scheme) {
  if (scheme.own_clock) return "sets its own clock, and every member would have a time of its own";
  if (scheme.implicit) return "solves equations at each step, and every member would need its own number of iterations";
  return {};
}

bool is_of_state(const ColumnCard& column) {
  constexpr std::array<std::string_view, 5> of_a_step{"step_size", "mode", "parameter", "discrete_energy", "error"};
  return std::ranges::find(of_a_step, column.name) == of_a_step.end();
}

namespace {

Grid grid_of(const EnsemblePlan& plan) {
  const Request& request = plan.request;
  const SchemeCard& scheme = request.scene->mechanics->schemes()[request.scheme];
  return {request, request.settings[*scheme.find("step")]};
}

/// Calls see(t) at each of the times of a stroboscopic section.
template <class See>
void each_section_time(const EnsemblePlan& plan, See&& see) {
  const Request& request = plan.request;
  SectionTimes times(request.section, request.scene->start);
  const double end = request.until_steps ? grid_of(plan).end : request.end;
  for (std::int64_t seen = 0; times.time() <= end && seen < plan.request.most_points(); times.next(), ++seen)
    see(times.time());
}

/// each_row_time calls see(t) for the rows of trajectories.
template <class See>
void each_row_time(const EnsemblePlan& plan, See&& see) {
  if (!plan.trajectories) return;
  const Grid grid = grid_of(plan);
  SaveSchedule schedule(plan.request, grid.end);
  const std::int64_t most = std::min(grid.steps, plan.request.limits.steps);
  for (; schedule.step() <= most; schedule.next()) {
    const bool last = schedule.step() == grid.steps && grid.tail == 0;
    see(last ? grid.end : grid.time(schedule.step()));
  }
  for (; schedule.time() <= grid.end; schedule.next()) see(schedule.time());
}

}  // namespace

std::size_t section_count(const EnsemblePlan& plan) {
  std::size_t count = 0;
  each_section_time(plan, [&](double) { ++count; });
  return count;
}

std::size_t row_count(const EnsemblePlan& plan) {
  std::size_t count = 0;
  each_row_time(plan, [&](double) { ++count; });
  return count;
}

std::size_t bytes_of_block(const EnsemblePlan& plan) {
  constexpr std::size_t of_a_point = 3;  // numbers beside the columns: its member, crossing and time
  const auto members =
      static_cast<std::size_t>(std::min(plan.last, (plan.first_block() + 1) * block_size) - plan.first);
  const std::size_t columns = plan.request.columns.size();
  std::size_t numbers = members * row_count(plan) * columns;
  if (const std::size_t points = section_count(plan); points > 0)
    numbers +=
        std::min(members * points, static_cast<std::size_t>(plan.request.most_points())) * (columns + of_a_point);
  return numbers * sizeof(double);
}

std::vector<Look> looks_of(const EnsemblePlan& plan) {
  std::vector<Look> looks;
  looks.reserve(section_count(plan) + row_count(plan));
  each_section_time(plan, [&](double t) { looks.push_back({t, false}); });
  const auto points = static_cast<std::ptrdiff_t>(looks.size());
  each_row_time(plan, [&](double t) { looks.push_back({t, true}); });
  std::ranges::inplace_merge(looks, looks.begin() + points, {}, &Look::t);
  return looks;
}

ReturnCode run_ensemble(const EnsemblePlan& plan, const Shard& shard, unsigned threads,
                        const std::atomic<bool>& cancelled, const TakeBlock& take, const Share& share,
                        MemoryBudget* memory) {
  Blocks blocks(plan, shard, std::max(threads, 1U), cancelled, share, memory);
  while (auto block = blocks.take())
    if (!take(*block)) return ReturnCode::cancelled;
  return blocks.reason();
}

}  // namespace least
