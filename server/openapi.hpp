// The interface as an OpenAPI 3.1 document, generated once: parameters from the cards, endpoints from `operations`.
#pragma once

#include <string>

#include "server/decode/simulate_request.hpp"

namespace least::server {

/// GET /v1/openapi.json. All of its examples are requests that are answered with 200.
std::string write_openapi(const Cards& cards, const Caps& caps);

/// example_of returns one example of a POST path; null for other paths.
Json example_of(std::string_view path, const Cards& cards);

}  // namespace least::server
