// Reads a request for the scheme `auto`.
#pragma once

#include "server/decode/field_reader.hpp"
#include "server/decode/simulate_request.hpp"

namespace least::server {

/// read_wish reads the members of the scheme object besides its id.
Wish read_wish(const Json& json, const FieldPath& path, const Caps& caps);

}  // namespace least::server
