// Many runs of one scene: the request, and its computation in blocks of members on several threads.
#pragma once

#include <atomic>
#include <functional>
#include <optional>

#include "core/ensemble/block.hpp"
#include "core/ensemble/members.hpp"

namespace least {

/// EnsemblePlan is a checked request for an ensemble: every number of every member is within the range of its card.
struct EnsemblePlan {
  /// `request` has the scene that the members vary, the columns, and the limits: `steps` per member, `seconds` in all.
  /// If it has a section, the section's points are kept; `record` says which rows trajectories have.
  Request request;
  Members members;
  std::int64_t first = 0, last = 0;  ///< members [first, last)
  bool statistics = true, final = false, trajectories = false;
  std::vector<HistogramAsked> histograms;

  std::int64_t first_block() const { return first / block_size; }
  std::int64_t end_block() const { return (last + block_size - 1) / block_size; }
};

/// ensemble_objection returns why a scheme cannot run ensembles; empty where it can.
std::string ensemble_objection(const SchemeCard& scheme);
/// is_of_state tells whether a column is a function of a single state.
bool is_of_state(const ColumnCard& column);

/// Look is a time at which every member is observed: for a row of its trajectory, or for a point of a stroboscopic
/// section.
struct Look {
  double t;
  bool row;
};
/// looks_of returns all looks up to the end, in order. A row at the end is bitwise the state there.
std::vector<Look> looks_of(const EnsemblePlan& plan);
/// section_count and row_count return how many looks are for a section and for rows.
std::size_t section_count(const EnsemblePlan& plan);
std::size_t row_count(const EnsemblePlan& plan);

/// bytes_of_block returns the memory of the points of a section by time and of the rows of trajectories that the first
/// block of members keeps until it is handed over: no block can be computed with less.
std::size_t bytes_of_block(const EnsemblePlan& plan);

/// Shard selects the blocks whose number is `index` modulo `of`.
struct Shard {
  std::int64_t index = 0, of = 1;
};

/// first_block returns the first block of the shard that has members of the plan.
std::int64_t first_block(const EnsemblePlan& plan, const Shard& shard);

/// TakeBlock receives the blocks in order and may move out their contents; false ends the ensemble.
using TakeBlock = std::function<bool(Block&)>;

/// Share returns how many threads may compute at present, at least one. It may be called by any of them.
using Share = std::function<unsigned()>;

/// run_ensemble runs the members of a shard on `threads` threads, or on as many of them as `share` allows. Returns
/// `completed`, or why it ended early (deadline, cancelled, memory); the blocks received until then are complete, and
/// the first ones. Their memory is charged to `memory`, if given, before it is taken; where it is short, fewer blocks
/// are computed at once.
ReturnCode run_ensemble(const EnsemblePlan& plan, const Shard& shard, unsigned threads,
                        const std::atomic<bool>& cancelled, const TakeBlock& take, const Share& share = {},
                        MemoryBudget* memory = nullptr);

}  // namespace least
