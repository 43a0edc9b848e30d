// What a scene as text says of its pictures: `views`, columns drawn together, and `bodies`, what moves and what links
// it.
#pragma once

#include "core/run/mechanics.hpp"
#include "core/text/written_out.hpp"
#include "server/decode/field_reader.hpp"

namespace least::server {

/// Reads `views` and `bodies` of a problem after noting what is wrong with their shape: kinds that there are not, links
/// to bodies that do not exist.
text::Pictures read_pictures(const Json& problem, const FieldPath& path);

/// Notes entries of them that are neither a column of the scene nor an expression of its names.
void check_pictures(const text::Pictures& pictures, const FieldPath& path, const Scene& scene);

}  // namespace least::server
