// The first run of a search for a scheme: one near the accuracy by a scheme that suits most motions.
#pragma once

#include <atomic>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/study/study.hpp"

namespace least {

/// What it took bounds what others are worth, where an event of the caller's ends it nothing is to be measured beyond,
/// and where nothing better is found in time it is the choice.
struct Pilot {
  std::optional<SchemeConfig> choice;  ///< none of the candidates sets its own steps: there was no such run
  double end = 0;                      ///< the time it came to
  std::string event;                   ///< the stopping event that ended it; empty: none did
  bool completed = false;              ///< it came to that event, or to the end
  double seconds = 0;                  ///< that it took
  std::vector<SchemeConfig> others;    ///< of other schemes that set their own steps by a tolerance

  /// By the Taylor series; where that stops short, by Dormand–Prince 5(4), which gets past places without a series.
  static Pilot run(const Request& scene, std::span<const SchemeConfig> candidates, double accuracy, double seconds,
                   const std::atomic<bool>& cancelled);
};

}  // namespace least
