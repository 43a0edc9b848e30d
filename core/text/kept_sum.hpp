// Sums of many terms, recorded on a tape as sums of terms that share one formula.
#pragma once

#include "core/text/expansion.hpp"

namespace least::text {

/// record_sum records kept sum number `which` on the tape, with `words` giving the meaning of names. `summed` is
/// increased by the operations of all its terms; more than most_kept are refused.
std::variant<Symbol, Fault> record_sum(const KeptSums& sums, std::size_t which, tape::Tape& tape, const Words& words,
                                       std::size_t& summed);

}  // namespace least::text
