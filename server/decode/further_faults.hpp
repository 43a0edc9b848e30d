// Finds all faults of a scene given as text, where some hide others: definitions are read before the texts that use
// them.
#pragma once

#include <vector>

#include "core/text/written_out.hpp"

namespace least::server {

/// further_faults returns, besides `first`, the faults that appear when the faulty texts are replaced by numbers,
/// repeatedly. The search ends where a variable, a parameter or a Lagrangian would have to be replaced.
std::vector<text::DefinitionFault> further_faults(text::TypedScene typed, std::vector<text::DefinitionFault> first);

}  // namespace least::server
