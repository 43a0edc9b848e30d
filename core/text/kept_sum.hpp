// Sums of many terms as what a tape keeps of terms alike.
#pragma once

#include "core/text/expansion.hpp"

namespace least::text {

/// Sum number `which` on the tape, with the names as `words` has them. `summed`: gets the operations of all terms; more
/// than most_kept are refused.
std::variant<Symbol, Fault> record_sum(const KeptSums& sums, std::size_t which, tape::Tape& tape, const Words& words,
                                       std::size_t& summed);

}  // namespace least::text
