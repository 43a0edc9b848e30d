#include "core/variations/walk_with.hpp"

namespace least::variations {

WalkClass walk_of_damped([[maybe_unused]] std::size_t coordinates, bool full_mass, bool constant) {
  if (full_mass)
    return {constant ? walk_among_all<VariedDamped<VariedFullMass<8>>>
                     : walk_among_all<VariedTimedDamped<VariedFullMass<8>>>,
            8};
#ifndef LEAST_FEW_SIZES
  if (coordinates <= 2)
    return {
        constant ? walk_among_all<VariedDamped<VariedMasses<2>>> : walk_among_all<VariedTimedDamped<VariedMasses<2>>>,
        2};
#endif
  return {constant ? walk_among_all<VariedDamped<VariedMasses<8>>> : walk_among_all<VariedTimedDamped<VariedMasses<8>>>,
          8};
}

}  // namespace least::variations
