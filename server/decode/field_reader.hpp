// Reading single values of a request: each function returns the value, or nothing after noting a fault.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/describe.hpp"
#include "server/decode/json_parse.hpp"
#include "server/decode/wording.hpp"
#include "server/shared/fault.hpp"

namespace least::server {

/// Integers beyond this are not exact as doubles.
inline constexpr std::int64_t greatest_count = 9'007'199'254'740'992;  // 2⁵³

/// A field of the request, as a JSON pointer, and where its faults go.
struct FieldPath {
  std::string pointer;
  Faults* faults;

  FieldPath at(std::string_view key) const { return {pointer + pointer_step(key), faults}; }
  FieldPath at(std::size_t index) const { return {pointer + "/" + std::to_string(index), faults}; }
  void fault(std::string detail, const Json& value, std::string allowed = {}) const {
    faults->add({pointer, std::move(detail), shown(value), std::move(allowed)});
  }
  /// `; did you mean "leapfrog"?`, for the first faults only: the search is dear.
  std::string meant(std::string_view word, const Names& names) const {
    return faults->may_suggest() ? did_you_mean(word, names) : std::string();
  }
  /// A fault of something that is not there.
  void lacks(std::string detail, std::string allowed = {}) const {
    faults->add({pointer, std::move(detail), {}, std::move(allowed)});
  }
};

inline const Json* find(const Json& object, std::string_view key) {
  const auto it = object.is_object() ? object.find(key) : object.end();
  return it == object.end() ? nullptr : &*it;
}

/// Whether `json` is an object; notes its keys that are not among `known`.
bool read_object(const Json& json, const FieldPath& path, const Names& known, std::string_view owner);

/// A finite number within the range. `other` says in a fault what else may stand there (` or null`).
std::optional<double> read_number(const Json& json, const FieldPath& path, const Range& range,
                                  std::string_view other = {});

/// A whole number within the range; 5.0 is whole.
std::optional<double> read_whole(const Json& json, const FieldPath& path, const Range& range,
                                 std::string_view other = {});
std::optional<std::int64_t> read_integer(const Json& json, const FieldPath& path, std::int64_t low, std::int64_t high);

/// The position of a string among the names; `what` says what they are ("problem"), `other` what else may stand there.
std::optional<std::size_t> read_name(const Json& json, const FieldPath& path, const Names& names, std::string_view what,
                                     std::string_view other = {});

/// A list of names without repetition, as positions among the known ones.
std::vector<std::size_t> read_names(const Json& json, const FieldPath& path, const Names& known, std::string_view what);

/// The value of a parameter as the core holds it: a choice by its index, a flag as 0 or 1, null or the card's word for
/// it as NaN; {"weights": […]} by the index after the last choice, the list itself in `weights`.
std::optional<double> read_parameter(const Json& json, const FieldPath& path, const ParameterCard& card,
                                     std::vector<double>& weights);

}  // namespace least::server
