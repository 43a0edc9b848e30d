// What to report: columns by name or as expressions of the caller's own, events that are such, and diagnostics.
#pragma once

#include "core/ensemble/members.hpp"
#include "server/decode/field_reader.hpp"

namespace least::server {

/// Reads the `expression` of an object, which is called so, by the reader: a MeasureReader or a MemberReader.
template <class Reader>
void read_expression(const Json& object, const FieldPath& path, std::string name, Reader& reader);

/// Which zeros the `direction` of an object asks for: those where its expression rises (1), falls (−1), or both (0).
int read_way(const Json& object, const FieldPath& path);

/// Reads `columns` and `diagnostics` into the request, whose scene is set; of an ensemble with its members.
void read_columns(const Json& root, const FieldPath& top, const Members* members, Request& request);

/// Reads `events` into the request, whose scene and section are set.
void read_events(const Json& root, const FieldPath& top, Request& request);

}  // namespace least::server
