// Reads the text of a request body: strict JSON with bounds that keep hostile text cheap.
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

/// Bounds on a body, besides its length. A tree within them can be copied, walked and destroyed recursively.
struct JsonBounds {
  int depth = 16;
  std::size_t values = 250'000;
  std::size_t keys = 4096;         ///< in one object
  std::size_t looks = 20'000'000;  ///< at keys, together: ordered_json looks them up one by one
};

struct ParsedJson {
  Json tree;      ///< null where a bound was broken
  Faults faults;  ///< duplicate keys, numbers beyond a double, broken bounds
  Held held{};    ///< the bytes of the tree, where it is no small one
};

/// Why a text is no JSON at all, or was not read.
struct NotJson {
  std::size_t byte = 0;  ///< offset of the first byte that does not fit, from 0
  std::string detail;
  bool no_memory = false;
};

/// Bytes up to which a tree is a small one.
inline constexpr std::size_t small_tree = 64 * 1024;

/// Reads a text. Numbers too large for a double are faults at their place and stand as 0 in the tree, which counts in
/// `memory`, where there is any, from its beginning: it may be forty times as large as the text.
Result<ParsedJson, NotJson> parse_json(std::string_view text, const JsonBounds& bounds = {},
                                       MemoryBudget* memory = nullptr);

/// `/a~1b` from `a/b`: one step of a JSON pointer (RFC 6901). Long keys are cut.
std::string pointer_step(std::string_view key);

/// JSON text of a value for an error: long strings are cut, lists and objects are left out (empty).
std::string shown(const Json& value);

/// The longest beginning of `text` with at most `bytes` bytes that does not cut a character.
std::string_view clipped(std::string_view text, std::size_t bytes);

}  // namespace least::server
