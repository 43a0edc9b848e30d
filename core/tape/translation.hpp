// Translation is a tape as a list of operations, each with a value of its own, to be evaluated one after the other or
// in batches.
#pragma once

#include <span>
#include <vector>

#include "core/tape/operation.hpp"

namespace least::tape {

struct Translation {
  std::vector<Operation> steps;
  std::vector<Index> ends;   ///< the step of each output
  std::vector<Index> place;  ///< by node: the step that computes it; none if it is not needed
};

/// Returns the operations that compute the nodes `outputs` of the tape, in an order of evaluation.
Translation translated(const Tape& tape, std::span<const Index> outputs);

/// Whether an argument is a node of the kind `op` in every term.
bool is_all(const Tape& tape, const Terms& terms, Index argument, Op op);

}  // namespace least::tape
