#include "server/decode/auto_reader.hpp"

#include <cmath>
#include <limits>

namespace least::server {
namespace {

// asked returns the value of a key, null where it is absent or JSON null.
const Json* asked(const Json& json, std::string_view key) {
  const Json* value = find(json, key);
  return value && value->is_null() ? nullptr : value;
}

double read_asked(const Json& json, const FieldPath& path, std::string_view key, const Range& range) {
  const Json* value = asked(json, key);
  const auto number = value ? read_number(*value, path.at(key), range) : std::nullopt;
  return number.value_or(std::numeric_limits<double>::quiet_NaN());
}

}  // namespace

Wish read_wish(const Json& json, const FieldPath& path, const Caps& caps) {
  constexpr std::string_view shape = "{\"id\": \"auto\", \"accuracy\": …}, {\"id\": \"auto\", \"seconds\": …}";
  Wish wish;
  if (json.is_object()) read_object(json, path, {"id", "accuracy", "seconds", "keep"}, "auto");
  const ParameterCard& accuracy = auto_card().parameters[0];
  const bool says_accuracy = asked(json, "accuracy") != nullptr, says_seconds = asked(json, "seconds") != nullptr;
  if (says_accuracy && says_seconds) path.lacks("auto must hold either accuracy or seconds", std::string(shape));
  wish.accuracy = says_accuracy || says_seconds ? read_asked(json, path, "accuracy", accuracy.range) : accuracy.value;
  wish.seconds = read_asked(json, path, "seconds", {0, caps.seconds, true});
  if (const Json* keep = find(json, "keep")) {
    for (const auto kept : read_names(*keep, path.at("keep"), Names(keep_names.begin(), keep_names.end()), "name")) {
      (kept == 0 ? wish.keep.energy : kept == 1 ? wish.keep.structure : wish.keep.momenta) = true;
    }
  }
  return wish;
}

}  // namespace least::server
