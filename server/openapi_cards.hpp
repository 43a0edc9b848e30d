// What a request may say of a problem or a scheme of the catalogue, as JSON Schema made from its card.
#pragma once

#include "server/decode/json_parse.hpp"
#include "server/shared/cards.hpp"

namespace least::server {

/// `{"id", "preset", …}` with the parameters flat beside them.
Json entry_of(const ProblemCard& card);
Json entry_of(const SchemeCard& card);

/// `initial`: t, the variables, lists of those that are counted, and velocities where the problem takes them.
Json start_of(const Mechanics& problem);

}  // namespace least::server
