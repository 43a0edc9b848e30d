// The plane of a section as lanes see it.
#pragma once

#include <optional>

#include "core/ensemble/ensemble.hpp"

namespace least {

/// Lanes compare a variable with a number by themselves; of any other expression they show every state.
struct Level {
  int variable;
  double value = 0;
};
std::optional<Level> level_of(const Request& request);

/// Whether the expression is the same for all members and reads only what lanes show: not the energy, and no parameter
/// that varies.
bool is_of_lanes(const EnsemblePlan& plan);

}  // namespace least
