// The characters that formulas are made of.
#pragma once

#include <cstddef>
#include <string_view>

namespace least::text {

constexpr bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }
constexpr bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }
/// is_part tells whether a name may contain c behind its first letter.
constexpr bool is_part(char c) { return is_letter(c) || is_digit(c) || c == '_'; }

/// end_of_word returns the position behind the word that begins at `from`.
constexpr std::size_t end_of_word(std::string_view text, std::size_t from, std::size_t to) {
  while (from < to && is_part(text[from])) ++from;
  return from;
}

/// speaks_of tells whether a text contains this name, as a whole word.
constexpr bool speaks_of(std::string_view text, std::string_view name) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = is_letter(text[at]) ? end_of_word(text, at, text.size()) : at + 1;
    if (text.substr(at, end - at) == name) return true;
    at = end;
  }
  return false;
}

}  // namespace least::text
