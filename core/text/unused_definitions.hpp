// Definitions that no text of a scene's mechanics uses: their names are checked as they are typed.
#pragma once

#include <vector>

#include "core/text/definition.hpp"
#include "core/text/indices.hpp"
#include "core/text/written_out.hpp"

namespace least::text {

/// faults_in_unused returns the faults of definitions without indices that no other text uses. It writes out as many of
/// them as a request may have characters.
std::vector<DefinitionFault> faults_in_unused(const TypedScene& typed, const Vocabulary& vocabulary);

/// unknown_names_in_unused returns a fault for each definition that the mechanics do not use, directly or through other
/// definitions, and that contains a name nobody knows: the first such name. Columns and events may use these
/// definitions, but know no other names. `vocabulary` is that of the scene, with its definitions in the order typed.
/// The work is proportional to the length of all texts.
std::vector<DefinitionFault> unknown_names_in_unused(const TypedScene& typed, const Vocabulary& vocabulary);

}  // namespace least::text
