// The plane of a section as lanes can watch it.
#pragma once

#include <optional>

#include "core/ensemble/ensemble.hpp"

namespace least {

/// Level is a plane variable = value, which lanes compare by themselves. For any other expression lanes report every
/// state.
struct Level {
  int variable;
  double value = 0;
};
/// level_of returns the plane as a Level; nothing where it is no such plane.
std::optional<Level> level_of(const Request& request);

/// is_of_lanes tells whether the plane's expression is the same for all members and reads only what lanes have: neither
/// the energy nor a parameter that varies.
bool is_of_lanes(const EnsemblePlan& plan);

}  // namespace least
