// A tape as a list of operations, each with a value of its own: what is evaluated one after the other, or in batches.
#pragma once

#include <span>
#include <vector>

#include "core/tape/operation.hpp"

namespace least::tape {

struct Translation {
  std::vector<Operation> steps;
  std::vector<Index> ends;   ///< of what was asked for
  std::vector<Index> place;  ///< of nodes the step that computes them; none of those that are not needed
};

/// What computes these nodes of a tape.
Translation translated(const Tape& tape, std::span<const Index> outputs);

/// Whether an argument of terms is a constant, or a variable, of all of them.
bool is_all(const Tape& tape, const Terms& terms, Index argument, Op op);

}  // namespace least::tape
