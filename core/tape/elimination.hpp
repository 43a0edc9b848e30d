// Linear systems whose entries are symbols.
#pragma once

#include <vector>

#include "core/tape/symbol.hpp"

namespace least::tape {

/// Solves A x = b on a tape and puts x in the place of b. A is n × n, row-major, and is overwritten. Symbols have no
/// magnitude to choose a pivot by: the pivot is the first entry of its column that is not identically zero.
void eliminate(std::vector<Symbol>& a, std::vector<Symbol>& b);

}  // namespace least::tape
