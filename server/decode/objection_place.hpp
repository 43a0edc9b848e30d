// Where a request says what a scene as text objects to: an objection knows the text that it is about, which a request
// may have said for a whole list, or not at all where the scene is one of the catalogue.
#pragma once

#include <functional>

#include "core/run/request.hpp"
#include "core/text/scene.hpp"
#include "server/decode/field_reader.hpp"

namespace least::server {

/// Notes the objection at the text, where the request holds it; else at the parameter that alone brings it about, of
/// those that the request says; else at the start, or the problem. `holds`: whether there is none to a scene with other
/// parameters.
void add_objection(const Json& root, const FieldPath& top, const Scene& scene,
                   const text::TextScene::Objection& objection, const std::function<bool(const Scene&)>& holds);

}  // namespace least::server
