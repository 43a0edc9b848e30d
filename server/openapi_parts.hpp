// What schemas are made of (JSON Schema 2020-12).
#pragma once

#include <cmath>
#include <string>
#include <utility>

#include "core/describe.hpp"
#include "server/decode/json_parse.hpp"

namespace least::server {

/// With no properties but these.
inline Json object_of(Json properties, Json required = Json::array()) {
  Json schema{{"type", "object"}, {"properties", std::move(properties)}, {"additionalProperties", false}};
  if (!required.empty()) schema["required"] = std::move(required);
  return schema;
}
inline Json list_of(Json items) { return {{"type", "array"}, {"items", std::move(items)}}; }

inline void add_range(Json& schema, const Range& range) {
  if (std::isfinite(range.low)) schema[range.low_open ? "exclusiveMinimum" : "minimum"] = range.low;
  if (std::isfinite(range.high)) schema[range.high_open ? "exclusiveMaximum" : "maximum"] = range.high;
}
inline Json number_in(const Range& range) {
  Json schema{{"type", "number"}};
  add_range(schema, range);
  return schema;
}
inline Json count_in(std::int64_t low, std::int64_t high) {
  return {{"type", "integer"}, {"minimum", low}, {"maximum", high}};
}

/// A number, or a text of constants.
inline Json quantity() { return {{"type", {"number", "string"}}}; }

/// What may stand for a value, and beside it what it means.
inline Json described(Json schema, const std::string& doc, const std::string& unit) {
  if (!doc.empty()) schema["description"] = doc;
  if (!unit.empty()) schema["x-unit"] = unit;
  return schema;
}

inline Json either(Json a, Json b) { return {{"anyOf", Json::array({std::move(a), std::move(b)})}}; }

}  // namespace least::server
