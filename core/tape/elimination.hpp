// Linear systems whose entries are symbols.
#pragma once

#include <vector>

#include "core/tape/symbol.hpp"

namespace least::tape {

/// x with A x = b in the place of b, on a tape, where no pivot is a matter of numbers: rows with what is zero whatever
/// the state are not taken for one. A, row by row, is spoilt.
void eliminate(std::vector<Symbol>& a, std::vector<Symbol>& b);

}  // namespace least::tape
