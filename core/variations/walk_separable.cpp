#include "core/variations/walk_with.hpp"

namespace least::variations {

// One size: a small scene takes two or three times as long as it might, and the compiler half as long.
WalkClass walk_of_separable(bool full_mass) {
  if (full_mass) return {walk_among_all<VariedSeparable<VariedFullMass<8>>>, 8};
  return {walk_among_all<VariedSeparable<VariedMasses<8>>>, 8};
}

}  // namespace least::variations
