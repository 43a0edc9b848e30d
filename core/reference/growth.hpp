// How fast small differences grow along a motion, one direction after the other.
#pragma once

#include <span>
#include <vector>

#include "core/run/backend.hpp"
#include "core/run/mechanics.hpp"

namespace least {

/// Landmarks of the true motion from the start to `end`, or as far as it goes.
std::vector<PaceMark> pace_of(const RunBackend& backend, const RunState& start, double end,
                              const KeepGoing& keep_going);

/// `kinds`: of the variables, kinds_of the card.
Conditioning conditioning_of(const RunBackend& backend, const RunState& start, double end, const KeepGoing& keep_going,
                             std::span<const std::size_t> kinds);

}  // namespace least
