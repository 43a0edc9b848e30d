// Reads what to report: columns by name or as expressions of the request's own, events, and diagnostics.
#pragma once

#include "core/ensemble/members.hpp"
#include "server/decode/field_reader.hpp"

namespace least::server {

/// read_expression reads the `expression` of an object under the given name into the reader: a MeasureReader or a
/// MemberReader.
template <class Reader>
void read_expression(const Json& object, const FieldPath& path, std::string name, Reader& reader);

/// read_way returns which zeros the `direction` of an object selects: rising (1), falling (−1), or both (0).
int read_way(const Json& object, const FieldPath& path);

/// read_columns reads `columns` and `diagnostics` into the request, whose scene must be set. `members` are those of an
/// ensemble, null for a run.
void read_columns(const Json& root, const FieldPath& top, const Members* members, Request& request);

/// read_events reads `events` into the request, whose scene and section must be set.
void read_events(const Json& root, const FieldPath& top, Request& request);

}  // namespace least::server
