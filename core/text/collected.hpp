// Derived formulas as people write them: products multiplied out and like terms collected, where that is shorter.
#pragma once

#include <functional>
#include <string>

#include "core/tape/symbol.hpp"

namespace least::text {

/// print_collected returns y as text that the parser reads back: either a sum of terms, each a number times powers of
/// variables, functions and sums, or the text of `print` (core/text/print.hpp), whichever is shorter. Coefficients are
/// rounded to doubles, and x/x becomes 1 also where x is 0. `name` returns the name of a variable by its number.
std::string print_collected(const tape::Tape& tape, const Symbol& y, const std::function<std::string(int)>& name);

}  // namespace least::text
