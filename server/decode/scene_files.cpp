#include "server/decode/scene_files.hpp"

#include <algorithm>
#include <stdexcept>

#include "core/catalogue/custom.hpp"
#include "core/memory_budget.hpp"
#include "core/text/scene.hpp"
#include "server/decode/custom_reader.hpp"
#include "server/decode/scene_reader.hpp"

namespace least::server {
namespace {

// list_of returns a name without the index of an element.
std::string_view list_of(std::string_view name) { return name.substr(0, name.find('[')); }

std::string text_at(const Json& object, std::string_view key) {
  const Json* const json = find(object, key);
  return json ? json->get<std::string>() : std::string();
}
double time_at(const Json& object, std::string_view key) {
  const Json* const json = find(object, key);
  return json ? json->get<double>() : 0;
}
Json object_at(const Json& object, std::string_view key) {
  const Json* const json = find(object, key);
  return json ? *json : Json::object();
}
std::vector<NamedValue> numbers_at(const Json& object, std::string_view key) {
  std::vector<NamedValue> numbers;
  const Json all = object_at(object, key);
  for (const auto& [name, value] : all.items()) numbers.emplace_back(name, value.get<double>());
  return numbers;
}

class FileReader {
 public:
  FileReader(std::string_view path, std::string_view body) : path_(path) {
    auto parsed = parse_json(body);
    if (!parsed) throw std::logic_error(in_file("not JSON at byte " + std::to_string(parsed.error().byte)));
    faults_ = std::move(parsed->faults);
    file_ = std::move(parsed->tree);
    const Names keys{"title",   "summary", "references", "scene",   "about",
                     "initial", "until",   "suggested",  "presets", "events"};
    read_object(file_, top(), keys, "a scene of the catalogue");
    check();
  }

  TextProblem problem() {
    Json scene = object_at(file_, "scene");
    typed_ = read_custom(scene, top().at("scene"));
    check();
    ProblemCard card = described();
    for (const Json& preset : object_at(file_, "presets")) card.presets.push_back(preset_of(preset));
    text::TextScene known = *typed_->text();
    known.known = std::move(card);
    known.acts_by_default =
        std::ranges::any_of(object_at(file_, "events"), [](const Json& event) { return event.contains("set"); });
    auto made = mechanics_of(std::move(known));
    auto* const mechanics = std::get_if<std::shared_ptr<const Mechanics>>(&made);
    if (mechanics == nullptr) throw std::logic_error(in_file("has no mechanics"));
    const Json* const events = find(file_, "events");
    return {std::move(*mechanics), events ? *events : Json(), std::move(velocities_)};
  }

 private:
  FieldPath top() { return {"", &faults_}; }
  std::string in_file(const std::string& what) const { return "core/scenes" + std::string(path_) + ": " + what; }
  void check() const {
    if (faults_.empty()) return;
    const Fault& first = faults_.list().front();
    throw std::logic_error(in_file(first.pointer + " " + first.detail + "; allowed: " + first.allowed));
  }

  // scene_with returns the scene as a request would give it, with the values of a preset.
  Scene scene_with(const Json& preset) {
    std::vector<double>& velocities = velocities_[text_at(preset, "name")];
    Json problem = object_at(file_, "scene"), initial = object_at(file_, "initial");
    problem["id"] = custom_id;
    problem.update(object_at(preset, "parameters"));
    initial.update(object_at(preset, "initial"));
    Scene scene;
    scene.mechanics = typed_;
    const Json root = {{"problem", std::move(problem)}, {"initial", std::move(initial)}};
    read_scene(root, top(), scene, &velocities);
    check_start(root, top(), scene);
    check();
    return scene;
  }

  void describe(std::string_view of, std::string& symbol, std::string& unit, std::string& doc) const {
    const Json about = object_at(object_at(file_, "about"), list_of(of));
    if (auto text = text_at(about, "unit"); !text.empty()) unit = std::move(text);
    if (auto text = text_at(about, "doc"); !text.empty()) doc = std::move(text);
    const std::string shown = text_at(about, "symbol");
    if (!shown.empty()) symbol = shown + std::string(of.substr(std::min(of.find('['), of.size())));
  }

  ProblemCard described() {
    const ProblemCard& typed = typed_->card();
    const Scene start = scene_with(Json::object());
    ProblemCard card;
    card.id = path_.substr(1, path_.rfind('.') - 1);
    card.title = text_at(file_, "title");
    card.summary = text_at(file_, "summary");
    card.formula = typed.formula;
    card.span = time_at(file_, "until");
    for (const Json& reference : object_at(file_, "references")) card.references.push_back(reference);
    card.suggested = numbers_at(file_, "suggested");
    for (std::size_t i = 0; i < typed.variables.size(); ++i) {
      if (typed.variables[i].hidden) continue;
      VariableCard& variable = card.variables.emplace_back(typed.variables[i]);
      variable.value = start.initial[i];
      describe(variable.name, variable.symbol, variable.unit, variable.doc);
    }
    card.parameters = typed.parameters;
    for (ParameterCard& parameter : card.parameters)
      describe(parameter.name, parameter.symbol, parameter.unit, parameter.doc);
    Names known;
    for (const auto& variable : card.variables) known.push_back(list_of(variable.name));
    for (const auto& parameter : card.parameters) known.push_back(list_of(parameter.name));
    read_object(object_at(file_, "about"), top().at("about"), known, "what there is to be told of " + card.id);
    check();
    return card;
  }

  PresetCard preset_of(const Json& json) {
    read_object(json, top().at("presets"), {"name", "doc", "parameters", "initial", "until", "suggested"}, "a preset");
    const Scene scene = scene_with(json);
    PresetCard preset{text_at(json, "name"), text_at(json, "doc")};
    preset.span = time_at(json, "until");
    preset.suggested = numbers_at(json, "suggested");
    const ProblemCard& card = typed_->card();
    for (std::size_t i = 0; i < card.parameters.size(); ++i)
      preset.parameters.emplace_back(card.parameters[i].name, scene.parameters[i]);
    for (std::size_t i = 0; i < card.variables.size(); ++i)
      if (!card.variables[i].hidden) preset.initial.emplace_back(card.variables[i].name, scene.initial[i]);
    return preset;
  }

  std::string_view path_;
  Faults faults_;
  Json file_;
  std::shared_ptr<const Mechanics> typed_;
  std::map<std::string, std::vector<double>, std::less<>> velocities_;
};

}  // namespace

TextProblem read_scene_file(std::string_view path, std::string_view body) {
  try {
    return FileReader(path, body).problem();
  } catch (const nlohmann::json::exception& fault) {  // for example a number where a text is expected
    throw std::logic_error("core/scenes" + std::string(path) + ": " + fault.what());
  }
}

const std::vector<TextProblem>& text_problems() {
  static const std::vector<TextProblem> all = [] {
    const HeldByThread nobody(nullptr);  // not charged to any request, as they stay in memory
    std::vector<TextProblem> made;
    for (const SceneFile& file : scene_files()) {
      try {
        made.push_back(read_scene_file(file.path, file.body));
      } catch (const std::runtime_error&) {  // a development build without this form
      }
    }
    return made;
  }();
  return all;
}

const std::vector<double>& default_velocities(const text::TextScene& scene, std::string_view preset) {
  static const std::vector<double> none;
  if (!scene.known) return none;
  for (const TextProblem& one : text_problems()) {
    if (one.mechanics->text() != &scene) continue;
    const auto found = one.velocities.find(preset);
    return found == one.velocities.end() ? none : found->second;
  }
  return none;
}

const Json* own_events(const Mechanics& problem) {
  const text::TextScene* const text = problem.text();
  if (text == nullptr || !text->known) return nullptr;
  for (const TextProblem& one : text_problems())
    if (one.mechanics.get() == &problem) return one.events.is_null() ? nullptr : &one.events;
  return nullptr;
}

void refuse_own_events(const Mechanics& problem, const FieldPath& path) {
  if (own_events(problem) == nullptr) return;
  const std::string& id = problem.card().id;
  path.fault(id + " moves by events that act, which only single runs have", Json(id), "POST /v1/simulate");
}

}  // namespace least::server
