// Operations of a formula of which several are computed at once, where that is what terms of many scenes are made of:
// squares of distances, and their power −3/2. Every value is computed by the same operations in the same order.
#pragma once

#include <vector>

#include "core/tape/translation.hpp"

namespace least::tape {

enum class Fused : std::uint8_t {
  nothing,           ///< the operation alone
  two_squares,       ///< a² + b² + value
  three_squares,     ///< a² + b² + c² + value
  over_three_halves  ///< value/(a √a)
};

struct FusedStep {
  Operation operation;
  Fused fused = Fused::nothing;
  bool absorbed = false;  ///< it is computed by a later one
};

/// One for each step of the translation, with the same operands by number.
std::vector<FusedStep> fused(const Translation& from);

}  // namespace least::tape
