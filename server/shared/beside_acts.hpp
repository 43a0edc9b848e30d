// What compares a run with a motion that knows no acts: it is refused beside events that act, and stands on no card of
// a problem that moves by them.
#pragma once

#include <algorithm>
#include <array>
#include <string_view>

namespace least::server {

inline constexpr std::array<std::string_view, 5> diagnostics_without_acts{"error", "lyapunov", "decay", "orbit",
                                                                          "cycle"};
inline bool knows_acts(std::string_view diagnostic) {
  return std::ranges::find(diagnostics_without_acts, diagnostic) == diagnostics_without_acts.end();
}

}  // namespace least::server
