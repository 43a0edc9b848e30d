// A scene given as text: `{"id": "custom", "variables": […], "lagrangian": "…"}`.
#pragma once

#include <memory>

#include "core/run/mechanics.hpp"
#include "server/decode/field_reader.hpp"

namespace least::server {

inline constexpr std::string_view custom_id = "custom";

/// read_custom returns the mechanics that the problem of a request describes; null after noting what is wrong. Keys
/// that do not belong to a definition are ignored.
std::shared_ptr<const Mechanics> read_custom(const Json& problem, const FieldPath& path);

}  // namespace least::server
