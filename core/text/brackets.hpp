// Where parts of a text end: at brackets, at commas outside of brackets, and behind numbers.
#pragma once

#include <array>
#include <charconv>
#include <cstddef>
#include <string_view>

#include "core/text/characters.hpp"
#include "core/text/expression.hpp"

namespace least::text {

/// after_space returns the position of the next character that is not blank, at most `to`.
constexpr std::size_t after_space(std::string_view text, std::size_t at, std::size_t to) {
  while (at < to && is_space(text[at])) ++at;
  return at;
}

/// next_sign returns the position of the next bracket or comma, or `to` if there is none. Long texts are passed over by
/// it again and again, so that it looks each character up in a table.
constexpr std::size_t next_sign(std::string_view text, std::size_t at, std::size_t to) {
  constexpr auto signs = [] {
    std::array<bool, 256> is{};
    for (const char c : {'(', ')', '[', ']', ','}) is[static_cast<unsigned char>(c)] = true;
    return is;
  }();
  while (at < to && !signs[static_cast<unsigned char>(text[at])]) ++at;
  return at;
}

/// closing(text, open, to) returns the position of the bracket that closes the one at `open`, or `to` if there is none.
constexpr std::size_t closing(std::string_view text, std::size_t open, std::size_t to) {
  std::size_t depth = 0;
  for (std::size_t at = next_sign(text, open, to); at < to; at = next_sign(text, at + 1, to)) {
    if (text[at] == '(' || text[at] == '[') ++depth;
    if ((text[at] == ')' || text[at] == ']') && --depth == 0) return at;
  }
  return to;
}

/// comma(text, at, to) returns the position of the next comma outside of brackets, or `to` if there is none.
constexpr std::size_t comma(std::string_view text, std::size_t at, std::size_t to) {
  at = next_sign(text, at, to);
  for (std::size_t depth = 0; at < to; at = next_sign(text, at + 1, to)) {
    if (text[at] == '(' || text[at] == '[') ++depth;
    if (text[at] == ')' || text[at] == ']') --depth;
    if (text[at] == ',' && depth == 0) break;
  }
  return at;
}

/// end_of_number(text, from, to) returns the position behind the number that begins at `from`, its exponent included;
/// it is at least from + 1, so that a reader always advances.
inline std::size_t end_of_number(std::string_view text, std::size_t from, std::size_t to) {
  double value = 0;
  const auto read = std::from_chars(text.data() + from, text.data() + to, value);
  return std::max(from + 1, static_cast<std::size_t>(read.ptr - text.data()));
}

/// is_range tells whether an index range such as `i=1..n` stands between `from` and the next comma.
inline bool is_range(std::string_view text, std::size_t from, std::size_t to) {
  const std::size_t end = comma(text, from, to), equals = text.find('=', from);
  if (end == to || equals >= end || text[equals + 1] == '=') return false;
  const std::size_t begin = after_space(text, from, end);
  std::size_t last = equals;
  while (last > begin && is_space(text[last - 1])) --last;
  return is_name(text.substr(begin, last - begin));
}

}  // namespace least::text
