#include "server/decode/simulate_request.hpp"

#include "server/decode/auto_reader.hpp"
#include "server/decode/columns_reader.hpp"
#include "server/decode/field_reader.hpp"
#include "server/decode/plan_reader.hpp"
#include "server/decode/scene_reader.hpp"
#include "server/decode/section_reader.hpp"
#include "server/decode/sensitivities_reader.hpp"

namespace least::server {

Result<SimulateRequest, Faults> decode(ParsedJson body, const Cards& cards, const Caps& caps,
                                       const std::shared_ptr<const Mechanics>& known) {
  Faults faults = std::move(body.faults);
  const Json& root = body.tree;
  const FieldPath top{"", &faults};
  SimulateRequest decoded;
  Request& request = decoded.run;

  if (root.is_null() && !faults.empty()) return faults;  // a limit was exceeded: there is nothing to read
  const Names keys{"problem", "initial", "scheme",      "until",  "record", "columns",
                   "section", "events",  "diagnostics", "limits", "norm",   "sensitivities"};
  if (!read_object(root, top, keys, "the request")) return faults;

  const Json* const json = find(root, "scheme");
  Names ids = names_of(cards.schemes);
  ids.push_back(auto_card().id);
  const auto problem = known ? known : read_problem(root, top, cards);
  const NamedEntry scheme = read_entry(json, top.at("scheme"), "scheme", ids);
  const auto scene = std::make_shared<Scene>();
  scene->mechanics = problem;
  request.scene = scene;
  const bool automatic = scheme.index == cards.schemes.size();
  const SchemeCard* scheme_card = automatic ? &auto_card() : scheme.index ? &cards.schemes[*scheme.index] : nullptr;
  const PresetCard* preset = problem ? read_scene(root, top, *scene) : nullptr;
  if (problem) {
    check_start(root, top, *scene);
    read_direction(root, top, *scene);
  }
  const ProblemCard* problem_card = problem ? &scene->card() : nullptr;
  if (automatic) {
    decoded.wish = read_wish(*json, top.at("scheme"), caps);
    refuse_steps(root, top, "auto chooses the step: the end must be a time");
  } else if (scheme_card) {
    request.settings = read_settings(*json, top.at("scheme"), *scheme_card, scene.get(), preset);
    if (problem_card) {
      check_pair(cards, *scene, *scheme.index, scheme.path);
      check_settings(*scheme_card, *problem_card, request.settings, top.at("scheme"));
    }
  }
  read_norm(root, top, request);
  read_plan(root, top, problem_card, scheme_card, preset, caps, nullptr, request);

  if (problem_card) {
    read_section(root, top, scheme_card, request);
    read_events(root, top, request);
    read_sensitivities(root, top, scheme_card, decoded);
  }
  if (!faults.empty()) return faults;
  request.control = true;  // the control run is made whichever diagnostics are asked for
  request.scheme = automatic ? 0 : *scheme.index;
  return decoded;
}

}  // namespace least::server
