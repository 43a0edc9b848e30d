// The names that a text contains.
#pragma once

#include <cstddef>
#include <string_view>

#include "core/text/characters.hpp"
#include "core/text/indices.hpp"

namespace least::text {

/// each_name calls see(position, name) for the names in a text; an exponent, as in 1e5, is part of a number.
template <class See>
void each_name(std::string_view text, See&& see) {
  for (std::size_t at = 0; at < text.size();) {
    std::size_t end = at + 1;
    if (is_letter(text[at])) {
      end = end_of_word(text, at, text.size());
      see(at, text.substr(at, end - at));
    } else if (is_digit(text[at])) {
      end = end_of_word(text, at, text.size());
    }
    at = end;
  }
}

/// indices_set_in returns the indices of the sums and products of a text: i of `i = 1..n`.
inline Names indices_set_in(std::string_view text) {
  Names indices;
  each_name(text, [&](std::size_t at, std::string_view name) {
    std::size_t end = at + name.size();
    while (end < text.size() && is_space(text[end])) ++end;
    if (text.substr(end, 1) == "=" && text.substr(end, 2) != "==") indices.emplace(name);
  });
  return indices;
}

}  // namespace least::text
