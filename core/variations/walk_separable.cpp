#include "core/variations/walk_with.hpp"

namespace least::variations {

WalkClass walk_of_separable([[maybe_unused]] std::size_t coordinates, bool full_mass) {
  if (full_mass) return {walk_among_all<VariedSeparable<VariedFullMass<8>>>, 8};
#ifndef LEAST_FEW_SIZES
  if (coordinates <= 2) return {walk_among_all<VariedSeparable<VariedMasses<2>>>, 2};
#endif
  return {walk_among_all<VariedSeparable<VariedMasses<8>>>, 8};
}

}  // namespace least::variations
