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

}  // namespace least::text
