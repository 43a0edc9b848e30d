// The section of a request: of one run, or of the members of an ensemble.
#pragma once

#include "core/run/request.hpp"
#include "server/decode/field_reader.hpp"

namespace least::server {

inline constexpr std::string_view section_shape =
    "{\"period\": …, \"phase\": …}, {\"expression\": …, \"direction\": …}";

/// Into the request, whose columns are known, and before its events are: what is wrong with what stands there, and
/// nothing where there is no section. `scheme` may be null.
void read_section(const Json& root, const FieldPath& top, const SchemeCard* scheme, Request& request);

}  // namespace least::server
