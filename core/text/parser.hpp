// The grammar of texts: operations by precedence, functions with arguments, conditions.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "core/text/expression.hpp"

namespace least::text {

/// read_postfix appends the tokens of a text to `postfix` in postfix order, each a view into the text; it returns the
/// first fault, or nothing. It refuses more than `most` characters, and references to kept sums from number `sums` on.
std::optional<Fault> read_postfix(std::string_view text, std::size_t most, std::size_t sums,
                                  std::vector<Token>& postfix);

}  // namespace least::text
