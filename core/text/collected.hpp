// Derived formulas as people write them: products multiplied out and like terms put together, where that is shorter.
#pragma once

#include <functional>
#include <string>

#include "core/tape/symbol.hpp"

namespace least::text {

/// What stands on a tape, as text that the parser reads back: as a sum of terms, each a number times powers of
/// variables, functions and sums, or as `print` has it (core/text/print.hpp), whichever is shorter. Coefficients are
/// rounded as doubles are, and x/x is 1, also where x is 0. `name`: of a variable by its number.
std::string print_collected(const tape::Tape& tape, const Symbol& y, const std::function<std::string(int)>& name);

}  // namespace least::text
