// The scheme `auto`: what it says of itself and how a wish is read. The core knows no such scheme; it is chosen before
// a run.
#pragma once

#include <array>
#include <string_view>

#include "server/decode/field_reader.hpp"
#include "server/decode/simulate_request.hpp"

namespace least::server {

/// What `keep` may ask for.
inline constexpr std::array<std::string_view, 3> keep_names{"energy", "structure", "momenta"};

/// Its card, with all parameters but `keep`, which is a list.
const SchemeCard& auto_card();

/// Reads what stands beside the id.
Wish read_wish(const Json& json, const Place& place, const Caps& caps);

}  // namespace least::server
