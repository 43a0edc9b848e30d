// Schemas of POST /v1/periodic.
#pragma once

#include "server/decode/json_parse.hpp"

namespace least::server {

/// periodic_schemas() returns PeriodicRequest and PeriodicAnswer by name.
Json periodic_schemas();

}  // namespace least::server
