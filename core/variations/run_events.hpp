// The events that a run has met.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/run/outcome.hpp"
#include "core/run/request.hpp"

namespace least::variations {

/// An event of a run.
struct MetEvent {
  std::string name;
  double t = 0;
  std::optional<std::size_t> asked{};  ///< which of those that were asked for; none: one of the scheme's own
  bool ends = false;                   ///< the run
};

std::vector<MetEvent> events_of(const Request& request, const Solution& outcome);

}  // namespace least::variations
