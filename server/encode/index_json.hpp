// Lists of ids with titles and links, generated once.
#pragma once

#include <string>

#include "server/shared/cards.hpp"

namespace least::server {

/// GET /v1: the endpoints.
std::string write_index();
/// GET /v1/problems and /v1/schemes: `{"problems": [{"id", "title", "href"}]}`, in the order of the catalogue.
std::string list_problems(const Cards& cards);
std::string list_schemes(const Cards& cards);

}  // namespace least::server
