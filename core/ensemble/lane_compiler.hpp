// From what was written down (core/ensemble/traced.hpp) to what lanes run: what all members share is told from what
// they do not, what nobody reads is left out, what stands there twice is made once, and registers are given.
#pragma once

#include <utility>
#include <vector>

#include "core/ensemble/traced.hpp"

namespace least {

/// Which part of a trace is a program. Variables of the trace are the state, in the order of `rows`.
struct LaneSource {
  using Place = Trace::Place;
  const Trace* trace = nullptr;
  std::vector<bool> own;                      ///< of each constant of the trace whether members have their own
  std::vector<std::uint32_t> rows;            ///< where the variables stand on the card
  Place begin = 0, end = 0;                   ///< the step; what it reads of before is made at the start
  std::vector<std::pair<Place, Place>> kept;  ///< what it finds of the step before, and the same as it leaves it
  std::vector<Place> outputs;                 ///< the new state; of a program that makes no step its values
  bool steps = true;
  Place failed = -1;  ///< where it is not 0 the step failed
  std::int64_t forces_at_start = 0, forces_of_step = 0;
};

/// A program with what it is made of.
class CompiledLanes {
 public:
  explicit CompiledLanes(const LaneSource& source);
  LaneProgram program() const;
  /// Those constants of the trace that each member has of its own, in the order of their registers.
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
