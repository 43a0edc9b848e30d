// A scene given as text: `{"id": "custom", "variables": […], "lagrangian": "…"}`.
#pragma once

#include <memory>

#include "core/run/mechanics.hpp"
#include "server/decode/field_reader.hpp"

namespace least::server {

inline constexpr std::string_view custom_id = "custom";

/// read_custom returns the mechanics that the problem of a request describes. After noting faults it returns a
/// stand-in, mechanics with the same names in which each faulty text is replaced by a simple one, so that the rest of
/// the request can be read; null where the names are not known. Keys that do not belong to a definition are checked
/// only then.
std::shared_ptr<const Mechanics> read_custom(const Json& problem, const FieldPath& path);

}  // namespace least::server
