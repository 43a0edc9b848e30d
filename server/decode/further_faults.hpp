// All that is wrong with a scene given as text, where some of it hides the rest: a definition that cannot be read is
// read before the texts that use it.
#pragma once

#include <vector>

#include "core/text/written_out.hpp"

namespace least::server {

/// Of a scene in which these faults are found first, those that are found when numbers stand in the place of the texts
/// that they are in, and so on. Where variables, parameters or a Lagrangian would have to be replaced the search ends.
std::vector<text::DefinitionFault> further_faults(text::TypedScene typed, std::vector<text::DefinitionFault> first);

}  // namespace least::server
