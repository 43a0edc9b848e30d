// Reads the definitions of a scene, `r` or `d(i, j)`, before any text that uses them.
#pragma once

#include <vector>

#include "core/text/definition.hpp"
#include "core/text/indices.hpp"
#include "core/text/written_out.hpp"

namespace least::text {

/// read_definitions adds the definitions of a scene to its vocabulary, which must have its lists and constants. It
/// returns what is wrong with them: names that are something else already, names of definitions that are not above,
/// the first definition that becomes too large when it is written out, and faults of grammar in definitions without
/// indices, which read the same wherever they are used. `keeps`: sums of many terms are kept in the scene's texts. No
/// definition is written out in another one, so that the work is proportional to the length of all of them and the
/// sums in them.
std::vector<DefinitionFault> read_definitions(const TypedScene& typed, bool keeps, Vocabulary& vocabulary);

}  // namespace least::text
