// The first run of a search for a scheme: near the accuracy, by a scheme that suits most motions.
#pragma once

#include <atomic>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/study/study.hpp"

namespace least {

/// Pilot is that run. Its cost bounds which other runs are worthwhile; if a stopping event ended it, nothing is
/// measured beyond; and it is the choice if nothing better is found in time.
struct Pilot {
  std::optional<SchemeConfig> choice;  ///< none where no candidate is adaptive, and so no run was made
  double end = 0;                      ///< the time that it reached
  std::string event;                   ///< the stopping event that ended it; empty where none did
  bool completed = false;              ///< it reached that event, or the end
  double seconds = 0;                  ///< that it took
  std::vector<SchemeConfig> others;    ///< further adaptive candidates of other schemes

  /// run(…) uses the Taylor series; where that stops early, Dormand–Prince 5(4), which passes places without a series.
  static Pilot run(const Request& scene, std::span<const SchemeConfig> candidates, double accuracy, double seconds,
                   const std::atomic<bool>& cancelled);
};

}  // namespace least
