#include "core/variations/walk_with.hpp"

namespace least::variations {

// A single size, 8: it makes small scenes two or three times slower, and halves the time of compilation.
WalkClass walk_of_separable(bool full_mass) {
  if (full_mass) return {walk_among_all<VariedSeparable<VariedFullMass<8>>>, 8};
  return {walk_among_all<VariedSeparable<VariedMasses<8>>>, 8};
}

}  // namespace least::variations
