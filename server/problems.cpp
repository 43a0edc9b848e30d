#include "server/problems.hpp"

#include "core/catalogue/start_beside.hpp"
#include "core/text/scene.hpp"
#include "server/decode/scene_reader.hpp"
#include "server/encode/catalogue_json.hpp"
#include "server/encode/problem_document.hpp"

namespace least::server {

Prepared describe_scene(const Context& context, const HttpRequest& request) {
  const auto form = form_for(request, {"application/json"});
  if (!form) return form.error();
  auto body = json_of(context, request);
  if (!body) return std::move(body.error());
  Faults faults = std::move(body->faults);
  const FieldPath top{"", &faults};
  Scene scene;
  if (faults.empty() && read_object(body->tree, top, {"problem", "initial"}, "the request")) {
    scene.mechanics = read_problem(body->tree, top, context.cards);
    if (scene.mechanics) read_scene(body->tree, top, scene);
    if (scene.mechanics && body->tree.contains("initial")) check_start(body->tree, top, scene);
  }
  if (!faults.empty()) return problem_document(faults, request.id);
  const text::TextScene* const text = scene.mechanics->text();
  const bool asks_for_start = text && !text->known && !body->tree.contains("initial");
  const auto start = asks_for_start ? regular_start(scene) : std::nullopt;
  return Answer{200, "application/json", describe_problem(scene, asks_for_start ? &start : nullptr) + '\n', {}};
}

}  // namespace least::server
