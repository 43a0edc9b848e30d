// Symbols on a tape as text that the parser reads back.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "core/tape/symbol.hpp"

namespace least::text {

/// function_name returns the name of a function of one argument as it is typed, `sin`; nothing for any other operation.
std::optional<std::string_view> function_name(tape::Op op);

/// is_absolute tells whether the node, a choice, is between −x and x.
bool is_absolute(const tape::Tape& tape, const tape::Node& choice);

/// print returns y as text; `name` returns the name of a variable by its number. A text that would have more than a few
/// thousand characters, or deeper brackets than the parser accepts, is replaced by `…`.
std::string print(const tape::Tape& tape, const Symbol& y, const std::function<std::string(int)>& name);

}  // namespace least::text
