// Indices of lists: whole numbers, and conditions on them, which are settled when a text is written out.
//   + - * mod(a, n) ( )   of numbers, indices and whole-number constants
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

/// Indices are the names of indices and their values, the innermost last.
using Indices = std::vector<std::pair<std::string, std::int64_t>>;

/// Vocabulary is what a text may use besides the names that an Expression knows.
struct Vocabulary {
  struct Defined {
    std::string name;
    std::vector<std::string> indices;
    std::string text;
  };
  std::vector<Defined> definitions;                        ///< a definition may use only those before it
  std::map<std::string, std::int64_t, std::less<>> lists;  ///< by list, the number of its elements
  /// constants with whole values, which bounds and indices may use
  std::map<std::string, std::int64_t, std::less<>> constants;
  Names fixed;  ///< names of those constants that have been used so and are therefore numbers everywhere in the scene
};

/// value_of returns the value of the innermost index of this name; nothing where there is none.
std::optional<std::int64_t> value_of(std::string_view index, const Indices& indices);

/// read_index reads a part of a text as an index. `used` receives the whole-number constants that the index reads.
std::variant<std::int64_t, Fault> read_index(std::string_view text, std::size_t from, std::size_t to,
                                             const Vocabulary& vocabulary, const Indices& indices, Names& used);
/// read_condition reads a part of a text as a condition on indices.
std::variant<bool, Fault> read_condition(std::string_view text, std::size_t from, std::size_t to,
                                         const Vocabulary& vocabulary, const Indices& indices, Names& used);

/// speaks_of_indices tells whether a condition is settled when the text is written out: it consists of whole numbers
/// alone, and it contains an index, or nothing but sizes, or a comparison by == or !=, which only indices allow. A
/// parameter that happens to have a whole value does not make a condition one of indices.
bool speaks_of_indices(std::string_view condition, const Vocabulary& vocabulary, const Indices& indices);

}  // namespace least::text
