// The schemas of the OpenAPI document: requests (from the cards), answers and faults.
#pragma once

#include <string>

#include "server/decode/json_parse.hpp"
#include "server/decode/simulate_request.hpp"

namespace least::server {

/// reference returns a reference to a schema by name.
Json reference(const std::string& name);
/// schemas returns all of them by name.
Json schemas(const Cards& cards, const Caps& caps);

}  // namespace least::server
