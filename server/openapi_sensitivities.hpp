// The member `sensitivities` of requests and answers in OpenAPI.
#pragma once

#include "server/decode/json_parse.hpp"

namespace least::server {

Json sensitivities_asked();
Json sensitivities_found();

}  // namespace least::server
