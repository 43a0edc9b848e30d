#include "server/decode/study_request.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "server/decode/auto_reader.hpp"
#include "server/decode/plan_reader.hpp"
#include "server/decode/scene_files.hpp"
#include "server/decode/scene_reader.hpp"

namespace least::server {
namespace {

// StudyRequest is what requests of both studies have in common: a scene and schemes for it, within a time.
struct StudyRequest {
  const ProblemCard* problem = nullptr;
  const PresetCard* preset = nullptr;
  Request scene;
  std::vector<SchemeConfig> schemes;
};

// add_composed adds the settings with a composition, where the scheme accepts it.
void add_composed(const SchemeCard& card, const ProblemCard& problem, SchemeConfig choice, std::string_view composition,
                  std::vector<SchemeConfig>& all) {
  for (std::size_t i = 0; i < card.parameters.size(); ++i) {
    const auto& parameter = card.parameters[i];
    const auto found = std::find(parameter.choices.begin(), parameter.choices.end(), composition);
    if (parameter.name != "composition" || found == parameter.choices.end()) continue;
    choice.settings[i] = static_cast<double>(found - parameter.choices.begin());
    if (card.conflicts == nullptr || card.conflicts(choice.settings, problem).empty()) all.push_back(choice);
  }
}

// add_all adds every applicable scheme, with its defaults and with the composition that it recommends.
void add_all(const Cards& cards, const FieldPath& top, StudyRequest& study) {
  for (const auto index : study.problem->schemes) {
    const SchemeCard& card = cards.schemes[index];
    const SchemeConfig plain{index, read_settings({}, top, card, study.scene.scene.get(), study.preset)};
    study.schemes.push_back(plain);
    if (card.recommended.empty() || card.recommended == "none") continue;
    add_composed(card, *study.problem, plain, card.recommended, study.schemes);
  }
}

void read_choice(const Json& json, const FieldPath& path, const Cards& cards, StudyRequest& study) {
  if (json == auto_card().id || (json.is_object() && json.value("id", Json()) == auto_card().id)) {
    path.fault("auto chooses one of the schemes and is none to be measured", json);
    return;
  }
  const NamedEntry scheme = read_entry(&json, path, "scheme", names_of(cards.schemes));
  if (!scheme.index) return;
  const SchemeCard& card = cards.schemes[*scheme.index];
  study.schemes.push_back({*scheme.index, read_settings(json, path, card, study.scene.scene.get(), study.preset)});
  if (study.problem == nullptr) return;
  check_pair(cards, *study.scene.scene, *scheme.index, scheme.path);
  check_settings(card, *study.problem, study.schemes.back().settings, path);
}

void read_schemes(const Json& root, const FieldPath& top, const Cards& cards, StudyRequest& study) {
  constexpr std::string_view shape = "\"all\", [\"leapfrog\", {\"id\": …}, …]";
  const Json* json = find(root, "schemes");
  const FieldPath path = top.at("schemes");
  if (json == nullptr) {
    path.lacks("is required", std::string(shape));
  } else if (*json == "all") {
    if (study.problem) add_all(cards, top, study);
  } else if (!json->is_array() || json->empty() || json->size() > most_schemes) {
    path.fault(fmt::format("must be \"all\" or a list of 1 to {} schemes", most_schemes), *json, std::string(shape));
  } else {
    for (std::size_t i = 0; i < json->size(); ++i) read_choice((*json)[i], path.at(i), cards, study);
  }
}

// read_study reads the members that both requests have. False: there is nothing to read.
bool read_study(const Json& root, const FieldPath& top, const Names& keys, const Cards& cards, const Caps& caps,
                StudyRequest& study) {
  if (root.is_null() && !top.faults->empty()) return false;
  if (!read_object(root, top, keys, "the request")) return false;
  const auto problem = read_problem(root, top, cards);
  const auto scene = std::make_shared<Scene>();
  study.scene.scene = scene;
  if (problem) {
    scene->mechanics = problem;
    study.preset = read_scene(root, top, *scene);
    refuse_own_events(*problem, top.at("problem"));
    check_start(root, top, *scene);
    read_direction(root, top, *scene);
    study.problem = &scene->card();
  }
  read_schemes(root, top, cards, study);
  refuse_steps(root, top, "schemes are compared over a span of time: their steps have different lengths");
  read_end(root, top, study.problem, study.preset, study.scene);
  Limits& limits = study.scene.limits;
  limits.steps = caps.steps;
  limits.seconds = std::min(limits.seconds, caps.seconds);
  if (const Json* budget = find(root, "budget_seconds")) {
    limits.seconds = read_number(*budget, top.at("budget_seconds"), {0, caps.seconds, true}).value_or(limits.seconds);
  }
  return true;
}

}  // namespace

Result<StudyPlan, Faults> decode_work_precision(ParsedJson body, const Cards& cards, const Caps& caps) {
  Faults faults = std::move(body.faults);
  const Json& root = body.tree;
  const FieldPath top{"", &faults};
  const Names keys{"problem", "initial", "until", "schemes", "error", "norm", "budget_seconds"};
  StudyRequest study;
  if (!read_study(root, top, keys, cards, caps, study)) return faults;
  StudyPlan plan;
  if (const Json* error = find(root, "error")) {
    plan.at_end = read_name(*error, top.at("error"), {"final", "max"}, "measure") == 0;
  }
  read_norm(root, top, study.scene);
  if (!faults.empty()) return faults;
  plan.budget_seconds = study.scene.limits.seconds;
  plan.scene = std::move(study.scene);
  plan.schemes = std::move(study.schemes);
  return plan;
}

Result<StabilityPlan, Faults> decode_stability(ParsedJson body, const Cards& cards, const Caps& caps) {
  Faults faults = std::move(body.faults);
  const Json& root = body.tree;
  const FieldPath top{"", &faults};
  StudyRequest study;
  if (!read_study(root, top, {"problem", "initial", "schemes", "budget_seconds"}, cards, caps, study)) return faults;
  if (!faults.empty()) return faults;
  return StabilityPlan{std::move(study.scene), std::move(study.schemes)};
}

}  // namespace least::server
