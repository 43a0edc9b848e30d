// How a request asks for the scheme `auto`.
#pragma once

#include "server/decode/field_reader.hpp"
#include "server/decode/simulate_request.hpp"

namespace least::server {

/// Reads what stands beside the id.
Wish read_wish(const Json& json, const FieldPath& path, const Caps& caps);

}  // namespace least::server
