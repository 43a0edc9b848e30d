// Closed orbits → bytes.
#pragma once

#include <string>

#include "core/periodic/closed_orbit.hpp"

namespace least::server {

/// `application/json`: appends the next piece; false: it was the last.
bool encode_orbit(const periodic::Question& question, const periodic::Answer& found, std::size_t piece,
                  std::string& out);

/// `application/x-ndjson`: the first line, the scene and what was asked for; one for each member of the family; and the
/// last one, with all of the answer but the family.
std::string orbit_head_line(const periodic::Question& question);
std::string orbit_member_line(const periodic::Member& member);
std::string orbit_end_line(const periodic::Question& question, const periodic::Answer& found);

}  // namespace least::server
