// Finds the place in a request that causes an objection of a scene given as text. An objection names the text it
// concerns; the request may have given that text for a whole list, or not at all, for a problem of the catalogue.
#pragma once

#include <functional>

#include "core/run/request.hpp"
#include "core/text/scene.hpp"
#include "server/decode/field_reader.hpp"

namespace least::server {

/// add_objection notes the objection at that text, where the request contains it; else at the one parameter of the
/// request that causes it alone; else at the start or the problem. holds(scene) tells whether a scene with other
/// parameters is free of objections.
void add_objection(const Json& root, const FieldPath& top, const Scene& scene,
                   const text::TextScene::Objection& objection, const std::function<bool(const Scene&)>& holds);

}  // namespace least::server
