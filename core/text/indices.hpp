// Indices of many of a kind: whole numbers, and conditions among them, which are settled before anything is computed.
//   + - * mod(a, n) ( )   of numbers, indices and whole constants
//   < <= > >= == !=, and, or, not
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/text/expression.hpp"

namespace least::text {

using Names = std::set<std::string, std::less<>>;

/// The values of indices, the innermost last.
using Indices = std::vector<std::pair<std::string, std::int64_t>>;

/// What a text may speak of besides the names that an Expression knows.
struct Vocabulary {
  struct Defined {
    std::string name;
    std::vector<std::string> indices;
    std::string text;
  };
  std::vector<Defined> definitions;                            ///< each knows those before it
  std::map<std::string, std::int64_t, std::less<>> lists;      ///< how many elements a list has
  std::map<std::string, std::int64_t, std::less<>> constants;  ///< whole numbers, which bounds and indices may use
  Names fixed;                                                 ///< of those the ones that stand for numbers everywhere
};

/// The value of the innermost index of this name; nothing where there is none.
std::optional<std::int64_t> value_of(std::string_view index, const Indices& indices);

/// A part of a text as an index. `used`: gets the whole constants that it reads.
std::variant<std::int64_t, Fault> read_index(std::string_view text, std::size_t from, std::size_t to,
                                             const Vocabulary& vocabulary, const Indices& indices, Names& used);
/// The same as a condition.
std::variant<bool, Fault> read_condition(std::string_view text, std::size_t from, std::size_t to,
                                         const Vocabulary& vocabulary, const Indices& indices, Names& used);

/// Whether a condition is one of indices: of whole numbers alone, it speaks of an index, or of nothing but sizes, or
/// compares as only indices are compared. A parameter that happens to be whole makes none.
bool speaks_of_indices(std::string_view condition, const Vocabulary& vocabulary, const Indices& indices);

}  // namespace least::text
