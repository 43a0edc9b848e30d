// Diagnostics that compare a run with a motion without acting events: they are refused together with events that act,
// and omitted from the cards of problems whose motion includes such events.
#pragma once

#include <algorithm>
#include <array>
#include <string_view>

namespace least::server {

inline constexpr std::array<std::string_view, 5> diagnostics_without_acts{"error", "lyapunov", "decay", "orbit",
                                                                          "cycle"};
/// knows_acts tells whether a diagnostic can be asked for beside acting events.
inline bool knows_acts(std::string_view diagnostic) {
  return std::ranges::find(diagnostics_without_acts, diagnostic) == diagnostics_without_acts.end();
}

}  // namespace least::server
