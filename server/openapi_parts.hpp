// Building blocks of schemas (JSON Schema 2020-12).
#pragma once

#include <cmath>
#include <string>
#include <utility>

#include "core/describe.hpp"
#include "server/decode/json_parse.hpp"

namespace least::server {

/// object_of returns the schema of an object without further properties.
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

// Wherever a request has a number it may have a text of constants, such as "2*pi/3", which contains a digit or pi.
inline Json in_texts_too(const char* type) { return {{"type", {type, "string"}}, {"pattern", "[0-9]|pi"}}; }
inline Json quantity() { return in_texts_too("number"); }
inline Json whole_quantity() { return in_texts_too("integer"); }
inline Json number_in(const Range& range) {
  Json schema = quantity();
  add_range(schema, range);
  return schema;
}
inline Json count_in(std::int64_t low, std::int64_t high) {
  Json schema = whole_quantity();
  schema["minimum"] = low;
  schema["maximum"] = high;
  return schema;
}

/// described adds a description and a unit to a schema.
inline Json described(Json schema, const std::string& doc, const std::string& unit) {
  if (!doc.empty()) schema["description"] = doc;
  if (!unit.empty()) schema["x-unit"] = unit;
  return schema;
}

inline Json either(Json a, Json b) { return {{"anyOf", Json::array({std::move(a), std::move(b)})}}; }

}  // namespace least::server
