// What stands on a tape as text that the parser reads back.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "core/tape/symbol.hpp"

namespace least::text {

/// The function of one number that an operation is, as it is typed: `sin`; nothing where it is none.
std::optional<std::string_view> function_name(tape::Op op);

/// `name`: of a variable by its number. What would be longer than a few thousand characters, or nested deeper than the
/// parser takes, is `…`.
std::string print(const tape::Tape& tape, const Symbol& y, const std::function<std::string(int)>& name);

}  // namespace least::text
