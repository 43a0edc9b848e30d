// How large a text becomes when it is written out, by arithmetic on its ranges and definitions, without writing it.
#pragma once

#include <cstddef>
#include <string_view>

#include "core/text/indices.hpp"

namespace least::text {

/// most_terms_of_text bounds the terms of all sums and products of one text.
inline constexpr std::size_t most_terms_of_text = 150'000;
/// most_of_terms bounds the characters of all terms of a scene, those of kept sums included, which are read one by one.
inline constexpr std::size_t most_of_terms = 16 * most_kept;

/// size_of returns a lower bound of the size of a text that is written out. Ranges that depend on an index that is not
/// in `indices`, the index of an enclosing sum, are counted as far as a few thousand steps allow, else as empty ones.
/// Of an `if` the smaller branch counts. `vocabulary` has the sizes of its definitions. The work is proportional to the
/// length of the text. `place` receives the position of the first word from which on the text exceeds what a text may
/// have, if it does.
TextSize size_of(std::string_view text, const Vocabulary& vocabulary, const Indices& indices, bool keeps,
                 std::size_t& place);

/// add(all, part) adds a size to another one, up to a number far beyond all limits.
void add(TextSize& all, const TextSize& part);

/// too_many_operations_at is the fault of a text that becomes too large when it is written out.
Fault too_many_operations_at(std::size_t position);

/// exceeds tells whether a text of this size is refused; `keeps`: sums of many terms are kept in it.
constexpr bool exceeds(const TextSize& size, bool keeps) {
  return size.terms > most_terms_of_text || size.characters > most_of_terms ||
         (keeps ? size.with_kept_sums : size.characters) > most_written;
}

}  // namespace least::text
