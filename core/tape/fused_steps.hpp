// Fused steps compute several operations of a formula at once, where these are common in the terms of scenes: squares
// of distances, and their power −3/2. The arithmetic and its order, and so the bits, stay the same.
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
  bool absorbed = false;  ///< a later fused step computes it
};

/// Returns one fused step for each step of the translation; operands keep their numbers.
std::vector<FusedStep> fused(const Translation& from);

}  // namespace least::tape
