// What a request may contain for a problem or a scheme of the catalogue, as JSON Schema generated from its card.
#pragma once

#include "server/decode/json_parse.hpp"
#include "server/shared/cards.hpp"

namespace least::server {

/// entry_of returns the schema of `{"id", "preset", …}` with the parameters as further members.
Json entry_of(const ProblemCard& card);
Json entry_of(const SchemeCard& card);

/// start_of returns the schema of `initial`: t, the variables, lists of elements, and velocities where the problem
/// accepts them.
Json start_of(const Mechanics& problem);

}  // namespace least::server
