// Reads the pictures of a scene given as text: `views`, columns that are drawn together, and `bodies`, which move and
// are linked.
#pragma once

#include "core/run/mechanics.hpp"
#include "core/text/written_out.hpp"
#include "server/decode/field_reader.hpp"

namespace least::server {

/// read_pictures reads `views` and `bodies` and notes faults of their form: unknown kinds, links to bodies that do not
/// exist.
text::Pictures read_pictures(const Json& problem, const FieldPath& path);

/// check_pictures notes entries that are neither a column of the scene nor a valid expression.
void check_pictures(const text::Pictures& pictures, const FieldPath& path, const Scene& scene);

}  // namespace least::server
