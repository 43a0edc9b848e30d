// Compiles traces (core/ensemble/traced.hpp) to programs for lanes: separates numbers that all members share from those
// they do not, drops operations without use, merges equal ones, and allocates registers.
#pragma once

#include <utility>
#include <vector>

#include "core/ensemble/traced.hpp"

namespace least {

/// LaneSource is the part of a trace to compile. Variables of the trace are the components of the state, in the order
/// of `rows`.
struct LaneSource {
  using Place = Trace::Place;
  const Trace* trace = nullptr;
  std::vector<bool> own;            ///< by constant of the trace, whether each member has its own value
  std::vector<std::uint32_t> rows;  ///< by variable, its place on the card
  Place begin = 0, end = 0;         ///< range of the step; earlier operations that it reads are run once at the start
  std::vector<std::pair<Place, Place>> kept;  ///< (value from the step before, its replacement by this step)
  std::vector<Place> outputs;                 ///< the new state; of a program without a step, its values
  bool steps = true;
  Place failed = -1;  ///< not 0 where the step failed
  std::int64_t forces_at_start = 0, forces_of_step = 0;
};

/// CompiledLanes owns a compiled program.
class CompiledLanes {
 public:
  explicit CompiledLanes(const LaneSource& source);
  LaneProgram program() const;
  /// own() returns the constants of the trace of which each member has its own, in the order of their registers.
  const std::vector<std::size_t>& own() const { return own_; }

 private:
  friend class LaneCompiler;
  using Code = std::vector<LaneInstruction>;
  struct Part {
    Code of_step, of_members, of_time, of_lanes;
    LanePart view() const { return {of_step, of_members, of_time, of_lanes}; }
  };
  std::vector<double> shared_;
  std::vector<std::size_t> own_;
  std::vector<std::uint32_t> rows_, kept_shared_, kept_, outputs_;
  Part start_, step_;
  Code after_;
  std::size_t registers_ = 0;
  std::int32_t failed_ = -1;
  std::int64_t forces_at_start_ = 0, forces_of_step_ = 0;
};

}  // namespace least
