// The second half of decoding: how long to run, what to keep, what to report, how much it may cost.
#pragma once

#include "server/decode.hpp"
#include "server/reader.hpp"

namespace least::server {

/// Reads `until`, `record`, `columns`, `diagnostics` and `limits` into the request, whose start and settings are set.
/// Cards are null where they are not known; what depends on them is then left alone.
void read_plan(const Json& root, const Place& top, const ProblemCard* problem, const SchemeCard* scheme,
               double default_span, const Caps& caps, Request& request);

}  // namespace least::server
