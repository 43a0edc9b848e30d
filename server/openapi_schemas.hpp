// The schemas of the OpenAPI document: requests from the cards, answers and faults.
#pragma once

#include <string>

#include "server/decode/json_parse.hpp"
#include "server/decode/simulate_request.hpp"

namespace least::server {

/// To a schema by its name.
Json reference(const std::string& name);
/// All, by name.
Json schemas(const Cards& cards, const Caps& caps);

}  // namespace least::server
