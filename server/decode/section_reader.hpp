// The section of a request: of one run, or of the members of an ensemble.
#pragma once

#include <string_view>

#include "core/run/request.hpp"
#include "server/decode/field_reader.hpp"

namespace least::server {

inline constexpr std::string_view section_shape =
    "{\"period\": …, \"phase\": …}, {\"expression\": …, \"direction\": …}";

/// Names that a section of an answer has besides columns.
inline constexpr std::string_view names_of_a_section[] = {"member", "crossing",   "period",
                                                          "phase",  "expression", "direction"};

/// read_section reads the section into the request, whose columns must be known, before events are read. It does
/// nothing where there is no such member. `scheme` may be null.
void read_section(const Json& root, const FieldPath& top, const SchemeCard* scheme, Request& request);

}  // namespace least::server
