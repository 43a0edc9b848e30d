// Indices of lists: whole numbers, and conditions on them, which are settled when a text is written out.
//   + - * mod(a, n) ( )   of numbers, indices and whole-number constants
//   < <= > >= == !=, and, or, not
#pragma once

#include <cstdint>
#include <initializer_list>
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

/// TextSize is a lower bound of what a text becomes when it is written out; see core/text/text_size.hpp.
struct TextSize {
  std::size_t characters = 0;      ///< with all sums written out
  std::size_t with_kept_sums = 0;  ///< characters, where sums of many terms are kept
  std::size_t terms = 0;           ///< terms of all sums and products
  std::size_t kept = 0;            ///< operations of the terms of sums that may be kept
};

/// Definitions is a list of definitions in their order, found by their names. A definition may use only those before
/// it.
class Definitions {
 public:
  struct One {
    std::string name;
    std::vector<std::string> indices;
    std::string text;
    TextSize size{};
  };

  Definitions() = default;
  Definitions(std::initializer_list<One> all) {
    for (const One& one : all) push_back(one);
  }
  void push_back(One one) {
    numbers_.try_emplace(one.name, all_.size());
    all_.push_back(std::move(one));
  }
  /// number_of(name) returns the number of the definition of this name; size() where there is none.
  std::size_t number_of(std::string_view name) const {
    const auto known = numbers_.find(name);
    return known == numbers_.end() ? all_.size() : known->second;
  }
  const One& operator[](std::size_t number) const { return all_[number]; }
  std::size_t size() const { return all_.size(); }
  bool empty() const { return all_.empty(); }
  auto begin() const { return all_.begin(); }
  auto end() const { return all_.end(); }
  auto rbegin() const { return all_.rbegin(); }
  auto rend() const { return all_.rend(); }

 private:
  std::vector<One> all_;
  std::map<std::string, std::size_t, std::less<>> numbers_;
};

/// Vocabulary is what a text may use besides the names that an Expression knows.
struct Vocabulary {
  using Defined = Definitions::One;
  Definitions definitions{};
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
