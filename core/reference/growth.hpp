// How fast small differences grow along a motion.
#pragma once

#include <span>
#include <vector>

#include "core/run/backend.hpp"
#include "core/run/mechanics.hpp"

namespace least {

/// Returns landmarks of the true motion from the start to `end`, or as far as the motion goes and keep_going() allows.
std::vector<PaceMark> pace_of(const RunBackend& backend, const RunState& start, double end,
                              const KeepGoing& keep_going);

/// Returns how differences of the start grow until `end`, in all directions. `kinds`: the kinds of the variables,
/// kinds_of the card.
Conditioning conditioning_of(const RunBackend& backend, const RunState& start, double end, const KeepGoing& keep_going,
                             std::span<const std::size_t> kinds);

}  // namespace least
