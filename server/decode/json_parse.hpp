// Parses the text of a request body: strict JSON, with limits that keep hostile input cheap.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "server/shared/fault.hpp"
#include "server/shared/memory_budget.hpp"
#include "server/shared/result.hpp"

namespace least::server {

using Json = nlohmann::ordered_json;

/// JsonBounds are limits besides the length of the body. A tree within them can safely be copied, walked and destroyed
/// recursively.
struct JsonBounds {
  int depth = 16;
  std::size_t values = 250'000;
  std::size_t keys = 4096;         ///< in one object
  std::size_t looks = 20'000'000;  ///< key comparisons in all: ordered_json searches keys linearly
};

struct ParsedJson {
  Json tree;      ///< null where a limit was exceeded
  Faults faults;  ///< duplicate keys, numbers beyond a double, exceeded limits
  Held held{};    ///< the memory of the tree, unless it is small
};

/// NotJson says why a text is not JSON, or was not read.
struct NotJson {
  std::size_t byte = 0;  ///< offset of the first offending byte, from 0
  std::string detail;
  bool no_memory = false;
};

/// Trees up to this size are not charged.
inline constexpr std::size_t small_tree = 64 * 1024;

/// parse_json parses a text. Numbers too large for a double are noted as faults and become 0. The tree is charged to
/// `memory`, if given, while it grows: it may be forty times as large as the text.
Result<ParsedJson, NotJson> parse_json(std::string_view text, const JsonBounds& bounds = {},
                                       MemoryBudget* memory = nullptr);

/// pointer_step("a/b") returns `/a~1b`, one step of a JSON pointer (RFC 6901). Long keys are cut.
std::string pointer_step(std::string_view key);

/// shown returns the JSON text of a value for an error message: long strings are cut, lists and objects give an empty
/// text.
std::string shown(const Json& value);

/// clipped returns the longest prefix of at most `bytes` bytes that does not cut a UTF-8 character.
std::string_view clipped(std::string_view text, std::size_t bytes);

}  // namespace least::server
