#include "server/encode/catalogue_json.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/catalogue/catalogue.hpp"
#include "core/catalogue/recorded.hpp"
#include "core/run/columns.hpp"
#include "core/text/scene.hpp"
#include "core/text/sized_scene.hpp"
#include "core/text/velocities.hpp"
#include "core/text/written_out.hpp"
#include "server/encode/answer_parts.hpp"
#include "server/shared/beside_acts.hpp"

namespace least::server {
namespace {

void write_named(JsonWriter& json, const std::vector<NamedValue>& values) {
  json.open('{');
  for (const auto& [name, value] : values) json.key(name).number(value);
  json.close('}');
}

// NaN means that nothing is suggested.
void write_suggested(JsonWriter& json, std::vector<NamedValue> values) {
  std::erase_if(values, [](const NamedValue& suggestion) { return std::isnan(suggestion.second); });
  write_named(json, values);
}

// Writes the values of a preset, as a request spells them.
void write_settings(JsonWriter& json, const std::vector<ParameterCard>& cards, const std::vector<NamedValue>& values) {
  json.open('{');
  for (const auto& card : cards) {
    for (const auto& [name, value] : values) {
      if (name == card.name) write_parameter(json.key(name), card, value);
    }
  }
  json.close('}');
}

std::string_view type_of(Kind kind) {
  constexpr std::string_view names[] = {"number", "integer", "choice", "flag"};
  return names[static_cast<std::size_t>(kind)];
}

// Infinite bounds become null.
void write_range(JsonWriter& json, const Range& range) {
  json.key("minimum").number(range.low).key("maximum").number(range.high);
  json.key("exclusive_minimum").boolean(range.low_open).key("exclusive_maximum").boolean(range.high_open);
}

void write_parameter_card(JsonWriter& json, const ParameterCard& card) {
  json.open('{').key("name").text(card.name).key("symbol").text(card.symbol).key("doc").text(card.doc);
  json.key("unit").text(card.unit).key("type").text(type_of(card.kind)).key("default");
  write_parameter(json, card, card.value);
  if (card.kind == Kind::number || card.kind == Kind::integer) {
    write_range(json, card.range);
  }
  if (card.kind == Kind::choice) write_texts(json.key("choices"), card.choices);
  if (card.weights) json.key("weights").boolean(true);
  json.key("nullable").boolean(card.nullable);
  if (!card.word.empty()) json.key("word").text(card.word);
  if (!card.suggested.empty()) json.key("suggested").text(card.suggested);
  json.close('}');
}

void write_parameter_cards(JsonWriter& json, const std::vector<ParameterCard>& cards) {
  for (const auto& card : cards) write_parameter_card(json, card);
}

// Writes the parameter `keep` of `auto`, the only one that is a list of names.
void write_keep_card(JsonWriter& json) {
  json.open('{').key("name").text("keep").key("symbol").text("").key("doc").text("what the scheme must keep");
  json.key("unit").text("1").key("type").text("list").key("default").open('[').close(']');
  write_texts(json.key("choices"), keep_names);
  json.key("nullable").boolean(false).close('}');
}

void write_variables(JsonWriter& json, const std::vector<VariableCard>& variables) {
  json.open('[');
  for (const auto& v : variables) {
    if (v.hidden) continue;
    json.open('{').key("name").text(v.name).key("symbol").text(v.symbol).key("doc").text(v.doc);
    json.key("unit").text(v.unit).key("default").number(v.value).key("optional").boolean(v.optional);
    write_range(json, v.range);
    json.key("angle").boolean(v.angle).close('}');
  }
  json.close(']');
}

void write_presets(JsonWriter& json, const ProblemCard& card) {
  json.open('[');
  for (const auto& preset : card.presets) {
    json.open('{').key("name").text(preset.name).key("doc").text(preset.doc);
    write_settings(json.key("parameters"), card.parameters, preset.parameters);
    write_named(json.key("initial"), preset.initial);
    write_suggested(json.key("suggested"), preset.suggested);
    json.key("until").open('{').key("t").number(preset.span > 0 ? preset.span : card.span).close('}');
    json.close('}');
  }
  json.close(']');
}

void write_quantities(JsonWriter& json, const std::vector<QuantityCard>& quantities) {
  for (const auto& quantity : quantities) {
    json.open('{').key("name").text(quantity.name).key("symbol").text(quantity.symbol);
    json.key("doc").text(quantity.doc).close('}');
  }
}

// Writes what texts of a scene may contain, and their limits.
void write_language(JsonWriter& json) {
  json.key("language").open('{').key("functions").open('[');
  for (const auto function : text::function_names()) json.text(function);
  for (const char* of_many : {"sum", "prod", "mod"}) json.text(of_many);
  json.close(']').key("operators").open('[');
  for (const char* sign : {"+", "-", "*", "/", "^", "**", "<", "<=", ">", ">=", "and", "or", "not"}) json.text(sign);
  json.close(']').key("names").text(
      fmt::format("a letter, then letters, digits, _: at most {} before an index", text::longest_name));
  const std::pair<const char*, std::size_t> limits[] = {
      {"coordinates", text::most_coordinates},
      {"variables_of_equations", text::most_variables},
      {"coupled_velocities", text::Velocities::most_coupled},
      {"parameters", text::most_parameters},
      {"invariants", text::most_invariants},
      {"characters", text::most_characters},
      {"operations", text::most_operations},
      {"operations_of_long_sums", text::most_kept},
      {"operations_with_sums_written_out", text::most_summed},
      {"operations_of_columns_or_events", text::most_operations_beside},
      {"operations_of_the_motion", text::SizedScene::most_equations},
      {"nesting", text::most_nesting}};
  json.key("limits").open('{');
  for (const auto& [name, most] : limits) json.key(name).integer(static_cast<std::int64_t>(most));
  json.close('}').close('}');
}

// Writes what was recognised in the mechanics. Equations are written only for POST /v1/problems, as they are long with
// many bodies.
void write_form(JsonWriter& json, const text::TextScene& scene, bool with_equations) {
  const text::Form& form = *scene.form;
  json.key("form").open('{').key("kind").text(text::form_names[static_cast<std::size_t>(form.kind)]);
  json.key("autonomous").boolean(form.autonomous).key("keeps_energy").boolean(form.keeps_energy);
  if (form.forced) json.key("forced").boolean(true);
  json.close('}');
  if (!with_equations) return;
  const text::TextScene::Said equations = scene.equations();
  json.key("equations").open('{');
  for (const auto& [name, rate] : equations) json.key(name).text(rate);
  json.close('}');
  if (const std::string note = scene.note_on_equations(equations); !note.empty()) json.key("equations_note").text(note);
}

// What a scene as text has beside its form: of one of the catalogue that text, as a request gives it.
void write_text(JsonWriter& json, const text::TextScene& scene) {
  if (scene.definition.typed) write_pictures(json, scene.definition.typed->pictures);
  if (!scene.known) return write_language(json);
  json.key("text").open('{').key("id").text("custom");
  write_definition(json, scene.definition);
  json.close('}');
}

// recorded_words returns a compiled problem of the catalogue as a scene of equations, with the names of its card;
// nothing where its equations cannot be recorded.
std::optional<text::TextScene> recorded_words(const Scene& scene) {
  const ProblemCard& card = scene.card();
  std::vector<bool> named;
  text::Definition definition;
  definition.kind = text::Definition::Kind::equations;
  for (const auto& parameter : card.parameters) {
    named.push_back(parameter.kind == Kind::number);
    definition.parameters.emplace_back(parameter.name, parameter.value);
  }
  auto form = recorded_in_parameters(scene, named, false);
  if (!form) return std::nullopt;
  for (std::size_t i = 0; i < form->coordinates; ++i) definition.variables.push_back(card.variables[i].name);
  return text::TextScene::of(std::move(definition), std::move(form));
}

// Writes the coordinates that are not 0; null where no start was found at which a motion can begin.
void write_start(JsonWriter& json, const ProblemCard& card, const PossibleStart& start) {
  if (!start) return (void)json.null();
  json.open('{');
  for (std::size_t i = 0; i < start->size(); ++i)
    if ((*start)[i] != 0) json.key(card.variables[i].name).number((*start)[i]);
  json.close('}');
}

// `scene`: of the problem, whose form and equations are to be told, or null.
void write_problem_card(JsonWriter& json, const Mechanics& problem, std::span<const SchemeCard> schemes,
                        const Scene* scene = nullptr, const PossibleStart* start = nullptr) {
  const ProblemCard& card = problem.card();
  json.open('{').key("id").text(card.id).key("title").text(card.title).key("summary").text(card.summary);
  json.key("formula").text(card.formula);
  write_variables(json.key("variables"), card.variables);
  json.key("parameters").open('[');
  write_parameter_cards(json, card.parameters);
  json.close(']').key("until").open('{').key("t").number(card.span).close('}');
  write_suggested(json.key("suggested"), card.suggested);
  write_presets(json.key("presets"), card);
  json.key("invariants").open('[');
  if (card.keeps_energy || (problem.text() && problem.text()->form->keeps_energy)) {
    json.open('{').key("name").text("energy").key("symbol").text("H").key("doc").text("total energy").close('}');
  }
  write_quantities(json, card.invariants);
  json.close(']').key("quantities").open('[');
  write_quantities(json, card.quantities);
  json.close(']');
  const bool acts = problem.text() && problem.text()->acts_by_default;
  json.key("columns").open('[');
  for (const auto& column : card.columns) {
    if (!column.hidden && !(acts && column.name == error_column)) json.text(column.name);
  }
  json.close(']').key("diagnostics").open('[');
  for (const auto& diagnostic : card.diagnostics)
    if (!acts || knows_acts(diagnostic.name)) json.text(diagnostic.name);
  json.close(']');
  json.key("schemes").open('[');
  for (const auto index : card.schemes) json.text(schemes[index].id);
  json.text(auto_card().id).close(']').key("offers").text(card.offers);
  write_texts(json.key("references"), card.references);
  if (const text::TextScene* text = problem.text()) {
    write_form(json, *text, scene != nullptr);
    write_text(json, *text);
  } else if (const auto words = scene ? recorded_words(*scene) : std::nullopt) {
    write_form(json, *words, true);
  }
  if (start) write_start(json.key("start"), card, *start);
  json.close('}');
}

void write_order(JsonWriter& json, const SchemeCard& card) {
  if (card.orders.empty()) {
    json.null();
    return;
  }
  if (card.orders.size() == 1 && card.orders.front().first.empty()) {
    json.integer(card.orders.front().second);
    return;
  }
  json.open('{');
  for (const auto& [choice, order] : card.orders) json.key(choice).integer(order);
  json.close('}');
}

void write_scheme_card(JsonWriter& json, const SchemeCard& card) {
  json.open('{').key("id").text(card.id).key("title").text(card.title).key("summary").text(card.summary);
  write_order(json.key("order"), card);
  json.key("implicit").boolean(card.implicit).key("symmetric").boolean(card.symmetric);
  const bool keeps_volume = card.structure == "volume";  // volume is not a conserved form
  json.key("structure").text(keeps_volume ? "none" : card.structure);
  json.key("keeps_volume").boolean(keeps_volume);
  json.key("parameters").open('[');
  write_parameter_cards(json, card.parameters);
  if (&card == &auto_card()) write_keep_card(json);
  json.close(']').key("recommended");
  if (card.recommended.empty()) {
    json.null();
  } else {
    json.open('{').key("composition").text(card.recommended).close('}');
  }
  json.key("own_clock").boolean(card.own_clock).key("presets").open('[');
  for (const auto& preset : card.presets) {
    json.open('{').key("name").text(preset.name).key("doc").text(preset.doc);
    write_settings(json.key("parameters"), card.parameters, preset.settings);
    json.close('}');
  }
  json.close(']')
      .key("good_for")
      .text(card.good_for)
      .key("fails_when")
      .text(card.fails_when)
      .key("needs")
      .text(card.needs);
  write_texts(json.key("references"), card.references);
  json.close('}');
}

}  // namespace

std::string describe_problem(const Scene& scene, const PossibleStart* start) {
  std::string text;
  JsonWriter json(text);
  write_problem_card(json, *scene.mechanics, scene.mechanics->schemes(), &scene, start);
  return text;
}

CatalogueText describe(const Cards& cards) {
  CatalogueText text;
  for (const auto& problem : cards.problems) {
    JsonWriter json(text.problems[problem->card().id]);
    write_problem_card(json, *problem, cards.schemes);
  }
  for (const auto& card : cards.schemes) {
    JsonWriter json(text.schemes[card.id]);
    write_scheme_card(json, card);
  }
  JsonWriter automatic(text.schemes[auto_card().id]);
  write_scheme_card(automatic, auto_card());
  JsonWriter json(text.all);
  json.open('{').key("version").text(version).key("problems").open('[');
  for (const auto& problem : cards.problems) json.raw(text.problems.find(problem->card().id)->second);
  json.close(']').key("schemes").open('[');
  for (const auto& card : cards.schemes) json.raw(text.schemes.find(card.id)->second);
  json.raw(text.schemes.find(auto_card().id)->second);
  json.close(']').close('}');
  return text;
}

}  // namespace least::server
