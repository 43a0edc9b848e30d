// Closed orbits as bytes.
#pragma once

#include <string>

#include "core/periodic/closed_orbit.hpp"

namespace least::server {

/// encode_orbit appends piece number `piece` of the `application/json` answer; false: it was the last.
bool encode_orbit(const periodic::Question& question, const periodic::Answer& found, std::size_t piece,
                  std::string& out);

/// `application/x-ndjson`: the first line has the scene and the question, further lines a member of the family each,
/// and the last line the answer without the family.
std::string orbit_head_line(const periodic::Question& question);
std::string orbit_member_line(const periodic::Member& member);
std::string orbit_end_line(const periodic::Question& question, const periodic::Answer& found);

}  // namespace least::server
