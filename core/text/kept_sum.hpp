// Sums of many terms as what a tape keeps of terms alike.
#pragma once

#include "core/text/expansion.hpp"

namespace least::text {

/// The sum on the tape, with the names as `words` has them. `summed`: gets the operations of all terms; more than
/// most_kept are refused.
std::variant<Symbol, Fault> record_sum(const KeptSum& sum, tape::Tape& tape, const Words& words, std::size_t& summed);

}  // namespace least::text
