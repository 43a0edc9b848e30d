#include "server/decode/study_request.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "server/decode/auto_reader.hpp"
#include "server/decode/plan_reader.hpp"
#include "server/decode/scene_reader.hpp"

namespace least::server {
namespace {

// What both studies ask: a scene and schemes for it, within a time.
struct Subject {
  const ProblemCard* problem = nullptr;
  const PresetCard* preset = nullptr;
  Request scene;
  std::vector<Choice> schemes;
};

// The settings with a composition, where the scheme takes it here.
void add_composed(const SchemeCard& card, const ProblemCard& problem, Choice choice, std::string_view composition,
                  std::vector<Choice>& all) {
  for (std::size_t i = 0; i < card.parameters.size(); ++i) {
    const auto& parameter = card.parameters[i];
    const auto found = std::find(parameter.choices.begin(), parameter.choices.end(), composition);
    if (parameter.name != "composition" || found == parameter.choices.end()) continue;
    choice.settings[i] = static_cast<double>(found - parameter.choices.begin());
    if (card.conflicts == nullptr || card.conflicts(choice.settings, problem).empty()) all.push_back(choice);
  }
}

// Every scheme that fits, as it stands in its card and with the composition that it recommends.
void add_all(const Cards& cards, const Place& top, Subject& subject) {
  for (const auto index : subject.problem->schemes) {
    const SchemeCard& card = cards.schemes[index];
    const Choice plain{index, read_settings({}, top, card, subject.problem, subject.preset)};
    subject.schemes.push_back(plain);
    if (card.recommended.empty() || card.recommended == "none") continue;
    add_composed(card, *subject.problem, plain, card.recommended, subject.schemes);
  }
}

void read_choice(const Json& json, const Place& place, const Cards& cards, Subject& subject) {
  if (json == auto_card().id || (json.is_object() && json.value("id", Json()) == auto_card().id)) {
    place.fault("auto chooses one of the schemes and is none to be measured", json);
    return;
  }
  const Chosen scheme = choose(&json, place, "scheme", names_of(cards.schemes));
  if (!scheme.index) return;
  const SchemeCard& card = cards.schemes[*scheme.index];
  subject.schemes.push_back({*scheme.index, read_settings(json, place, card, subject.problem, subject.preset)});
  if (subject.problem == nullptr) return;
  check_pair(cards, *subject.problem, *scheme.index, scheme.place);
  check_settings(card, *subject.problem, subject.schemes.back().settings, place);
}

void read_schemes(const Json& root, const Place& top, const Cards& cards, Subject& subject) {
  constexpr std::string_view shape = "\"all\", [\"leapfrog\", {\"id\": …}, …]";
  const Json* json = find(root, "schemes");
  const Place place = top.at("schemes");
  if (json == nullptr) {
    place.lacks("is required", std::string(shape));
  } else if (*json == "all") {
    if (subject.problem) add_all(cards, top, subject);
  } else if (!json->is_array() || json->empty() || json->size() > most_schemes) {
    place.fault(fmt::format("must be \"all\" or a list of 1 to {} schemes", most_schemes), *json, std::string(shape));
  } else {
    for (std::size_t i = 0; i < json->size(); ++i) read_choice((*json)[i], place.at(i), cards, subject);
  }
}

// The members that both requests have. False: there is nothing to read.
bool read_study(const Json& root, const Place& top, const Names& keys, const Cards& cards, const Caps& caps,
                Subject& subject) {
  if (root.is_null() && !top.faults->empty()) return false;
  if (!read_object(root, top, keys, "the request")) return false;
  const Chosen problem = choose(find(root, "problem"), top.at("problem"), "problem", names_of(cards.problems));
  if (problem.index) {
    subject.problem = &cards.problems[*problem.index];
    subject.scene.problem = *problem.index;
    subject.preset = read_scene(root, top, *subject.problem, subject.scene);
  }
  read_schemes(root, top, cards, subject);
  refuse_steps(root, top, "schemes are compared over a span of time: their steps have different lengths");
  read_end(root, top, subject.problem, subject.preset, subject.scene);
  Limits& limits = subject.scene.limits;
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
  const Place top{"", &faults};
  const Names keys{"problem", "initial", "until", "schemes", "error", "budget_seconds"};
  Subject subject;
  if (!read_study(root, top, keys, cards, caps, subject)) return faults;
  StudyPlan plan;
  if (const Json* error = find(root, "error")) {
    plan.at_end = read_name(*error, top.at("error"), {"final", "max"}, "measure") == 0;
  }
  if (!faults.empty()) return faults;
  plan.budget_seconds = subject.scene.limits.seconds;
  plan.scene = std::move(subject.scene);
  plan.schemes = std::move(subject.schemes);
  return plan;
}

Result<StabilityPlan, Faults> decode_stability(ParsedJson body, const Cards& cards, const Caps& caps) {
  Faults faults = std::move(body.faults);
  const Json& root = body.tree;
  const Place top{"", &faults};
  Subject subject;
  if (!read_study(root, top, {"problem", "initial", "schemes", "budget_seconds"}, cards, caps, subject)) return faults;
  if (!faults.empty()) return faults;
  return StabilityPlan{std::move(subject.scene), std::move(subject.schemes)};
}

}  // namespace least::server
