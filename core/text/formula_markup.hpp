// The formulas of a scene as presentation MathML.
#pragma once

#include <string>

#include "core/text/definition.hpp"

namespace least::text {

/// What a definition says, as <math>: L, H, V or the equations, then what stands beside them. Of a scene that speaks of
/// many of a kind as its author typed it: sums as sums, then the definitions.
std::string formula_of(const Definition& definition);

}  // namespace least::text
