// The grammar of texts: operations by their precedence, functions with their arguments, conditions.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "core/text/expression.hpp"

namespace least::text {

/// The tokens of a text of at most so many characters, in postfix order, each a part of the text; or what is wrong.
/// `sums`: how many kept sums it may speak of.
std::optional<Fault> read_postfix(std::string_view text, std::size_t most, std::size_t sums,
                                  std::vector<Token>& postfix);

}  // namespace least::text
