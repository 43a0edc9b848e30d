// The formulas of a scene as presentation MathML.
#pragma once

#include <string>

#include "core/text/definition.hpp"

namespace least::text {

/// formula_of returns a definition as <math>: L, H, V or the equations, then forces, damping and the like. A scene with
/// lists is shown as its author typed it: sums as sums, followed by the definitions.
std::string formula_of(const Definition& definition);

}  // namespace least::text
