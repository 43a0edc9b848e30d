// What to report: columns by name or as expressions of the caller's own, events that are such, and diagnostics.
#pragma once

#include "core/run/request.hpp"
#include "server/decode/field_reader.hpp"

namespace least::server {

/// Reads the `expression` of an object, which is called so, by the reader.
void read_expression(const Json& object, const FieldPath& path, std::string name, MeasureReader& reader);

/// Reads `columns` and `diagnostics` into the request, whose scene is set.
void read_columns(const Json& root, const FieldPath& top, Request& request);

/// Reads `events` into the request, whose scene is set.
void read_events(const Json& root, const FieldPath& top, Request& request);

}  // namespace least::server
