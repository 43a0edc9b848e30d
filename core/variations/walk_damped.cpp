#include "core/variations/walk_with.hpp"

namespace least::variations {

WalkClass walk_of_damped(bool full_mass, bool constant) {
  if (full_mass)
    return {constant ? walk_among_all<VariedDamped<VariedFullMass<8>>>
                     : walk_among_all<VariedTimedDamped<VariedFullMass<8>>>,
            8};
  return {constant ? walk_among_all<VariedDamped<VariedMasses<8>>> : walk_among_all<VariedTimedDamped<VariedMasses<8>>>,
          8};
}

}  // namespace least::variations
