#include "server/openapi_cards.hpp"

#include <cmath>

#include "core/text/scene.hpp"
#include "server/openapi_parts.hpp"

namespace least::server {
namespace {

Json values_of(const ParameterCard& card) {
  switch (card.kind) {
    case Kind::number:
      return number_in(card.range);
    case Kind::integer: {
      Json schema = whole_quantity();
      add_range(schema, card.range);
      return schema;
    }
    case Kind::choice: {
      Json names{{"type", "string"}, {"enum", card.choices}};
      if (!card.weights) return names;
      Json own = object_of({{"weights", list_of(quantity())}, {"order", {{"type", "integer"}}}}, {"weights"});
      return either(std::move(names), std::move(own));
    }
    case Kind::flag:
      return {{"type", "boolean"}};
  }
  return {};
}

Json parameter(const ParameterCard& card) {
  Json schema = values_of(card);
  if (card.nullable) {
    schema = either(std::move(schema), card.word.empty() ? Json{{"type", "null"}} : Json{{"const", card.word}});
  }
  schema = described(std::move(schema), card.doc, card.unit);
  std::string value;
  JsonWriter json(value);
  write_parameter(json, card, card.value);
  schema["default"] = Json::parse(value);
  // A problem may suggest another default.
  if (!card.suggested.empty()) schema["x-suggested"] = card.suggested;
  return schema;
}

template <class Card>
Json entry(const Card& card) {
  Json properties{{"id", {{"const", card.id}}}};
  if (!card.presets.empty()) {
    Json names = Json::array();
    for (const auto& preset : card.presets) names.push_back(preset.name);
    properties["preset"] = {{"type", "string"}, {"enum", names}, {"description", "fills in a named set of values"}};
  }
  for (const ParameterCard& one : card.parameters) properties[one.name] = parameter(one);
  Json schema = object_of(std::move(properties), {"id"});
  schema["title"] = card.title;
  schema["description"] = card.summary;
  return schema;
}

// add_lists adds, for elements such as `x[1]`, the list `x`.
template <class Items>
void add_lists(const Items& cards, Json& properties) {
  for (const auto& card : cards)
    if (card.name.ends_with("[1]"))
      properties[card.name.substr(0, card.name.size() - 3)] = described(list_of(quantity()), card.doc, card.unit);
}

}  // namespace

Json entry_of(const SchemeCard& card) { return entry(card); }

Json entry_of(const ProblemCard& card) {
  Json schema = entry(card);
  add_lists(card.parameters, schema["properties"]);
  return schema;
}

Json start_of(const Mechanics& problem) {
  const ProblemCard& card = problem.card();
  Json properties{{"t", described(quantity(), "the start time", "time")}};
  properties["t"]["default"] = 0;
  add_lists(card.variables, properties);
  if (const text::TextScene* text = problem.text(); text && text->takes_velocities()) {
    for (const auto& name : text->definition.variables) {
      const std::string velocity = text::velocity_name(name);
      const Json one = described(quantity(), "velocity, instead of the momentum", "");
      properties[velocity] = one;
      if (velocity.ends_with("[1]")) properties[velocity.substr(0, velocity.size() - 3)] = list_of(quantity());
    }
  }
  for (const VariableCard& variable : card.variables) {
    if (variable.hidden) continue;
    Json schema = number_in(variable.range);
    if (std::isnan(variable.value)) schema["type"].push_back("null");  // null: the value follows from the others
    schema = described(std::move(schema), variable.doc, variable.unit);
    if (std::isfinite(variable.value)) schema["default"] = variable.value;
    properties[variable.name] = std::move(schema);
  }
  return object_of(std::move(properties));
}

}  // namespace least::server
