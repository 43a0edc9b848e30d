// Readers of single values of a request. Each returns the value, or nothing after noting a fault.
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

/// Larger integers may not be exact as doubles.
inline constexpr std::int64_t greatest_count = 9'007'199'254'740'992;  // 2⁵³

/// Every finite number above 0.
inline constexpr Range positive{0, anywhere.high, true, true};

/// FieldPath is the place of a value in the request, as a JSON pointer, and the list that collects its faults.
struct FieldPath {
  std::string pointer;
  Faults* faults;

  FieldPath at(std::string_view key) const { return {pointer + pointer_step(key), faults}; }
  FieldPath at(std::size_t index) const { return {pointer + "/" + std::to_string(index), faults}; }
  void fault(std::string detail, const Json& value, std::string allowed = {}) const {
    faults->add({pointer, std::move(detail), shown(value), std::move(allowed)});
  }
  /// meant returns `; did you mean "leapfrog"?`; empty after the first few faults, as the search is expensive.
  std::string meant(std::string_view word, const Names& names) const {
    return faults->may_suggest() ? did_you_mean(word, names) : std::string();
  }
  /// lacks notes a fault of a value that is missing.
  void lacks(std::string detail, std::string allowed = {}) const {
    faults->add({pointer, std::move(detail), {}, std::move(allowed)});
  }
};

/// find returns the value of a key; null where `object` is no object or has no such key.
inline const Json* find(const Json& object, std::string_view key) {
  const auto it = object.is_object() ? object.find(key) : object.end();
  return it == object.end() ? nullptr : &*it;
}

/// read_object tells whether `json` is an object, and notes its keys that are not among `known`. `owner` names the
/// object in messages.
bool read_object(const Json& json, const FieldPath& path, const Names& known, std::string_view owner);

/// read_number returns a finite number within the range. `other` names, in the message, what else is allowed (such as `
/// or null`).
std::optional<double> read_number(const Json& json, const FieldPath& path, const Range& range,
                                  std::string_view other = {});

/// read_whole returns a whole number within the range; 5.0 counts as whole.
std::optional<double> read_whole(const Json& json, const FieldPath& path, const Range& range,
                                 std::string_view other = {});
std::optional<std::int64_t> read_integer(const Json& json, const FieldPath& path, std::int64_t low, std::int64_t high);

/// read_name returns the index of a string among the names. `what` says what they are ("problem"), `other` what else is
/// allowed.
std::optional<std::size_t> read_name(const Json& json, const FieldPath& path, const Names& names, std::string_view what,
                                     std::string_view other = {});

/// read_names returns a list of names without repetition, as indices among the known ones.
std::vector<std::size_t> read_names(const Json& json, const FieldPath& path, const Names& known, std::string_view what);

/// read_parameter returns the value as the core stores it: a choice as its index, a flag as 0 or 1, null or the card's
/// word for it as NaN, {"weights": […]} as the index behind the last choice, with the list in `weights`.
std::optional<double> read_parameter(const Json& json, const FieldPath& path, const ParameterCard& card,
                                     std::vector<double>& weights);

}  // namespace least::server
