// Many runs of one scene: what is asked, and its way through blocks of members on several threads.
#pragma once

#include <atomic>
#include <functional>
#include <optional>

#include "core/ensemble/block.hpp"
#include "core/ensemble/members.hpp"

namespace least {

/// Every number of the members stays within the range of its card.
struct EnsemblePlan {
  /// The scene that the members vary, the columns, the limits: `steps` of each, `seconds` of all. Where it has a
  /// section, its points are kept; of `record` the trajectories.
  Request request;
  Members members;
  std::int64_t first = 0, last = 0;  ///< members [first, last)
  bool statistics = true, final = false, trajectories = false;
  std::vector<HistogramAsked> histograms;

  std::int64_t first_block() const { return first / block_size; }
  std::int64_t end_block() const { return (last + block_size - 1) / block_size; }
};

/// Whether a scheme can run ensembles, or what it has against it, in words.
std::string ensemble_objection(const SchemeCard& scheme);
/// Whether a column follows from a state alone.
bool is_of_state(const ColumnCard& column);

/// A time at which every member is looked at: for a row of its trajectory, or for a point of a section by time.
struct Look {
  double t;
  bool row;
};
/// All of them up to the end, in their order. A row at the end is one of the state there, to the bit.
std::vector<Look> looks_of(const EnsemblePlan& plan);
/// How many are for a section, and for a row.
std::size_t section_count(const EnsemblePlan& plan);
std::size_t row_count(const EnsemblePlan& plan);

/// Which blocks are computed: those whose number leaves `index` when divided by `of`.
struct Shard {
  std::int64_t index = 0, of = 1;
};

std::int64_t first_block(const EnsemblePlan& plan, const Shard& shard);

/// Receives the blocks in their order, and may take what is in them; false ends the ensemble.
using TakeBlock = std::function<bool(Block&)>;

/// How many of the threads may compute for now, at least one. Any of them asks.
using Share = std::function<unsigned()>;

/// Runs the members of the shard on so many threads, or as many of them as the share says. `completed`, or why it ended
/// early (deadline, cancelled, memory): then the blocks that were received are whole, and the first ones. What they
/// hold is counted in `memory` before it is taken, where there is any; where that is short, fewer blocks are computed
/// at once.
ReturnCode run_ensemble(const EnsemblePlan& plan, const Shard& shard, unsigned threads,
                        const std::atomic<bool>& cancelled, const TakeBlock& take, const Share& share = {},
                        MemoryBudget* memory = nullptr);

}  // namespace least
