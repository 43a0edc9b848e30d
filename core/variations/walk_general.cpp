#include "core/variations/walk_with.hpp"

namespace least::variations {

WalkClass walk_of_quadratic(bool full_mass) {
  return {
      full_mass ? walk_among_all<VariedQuadratic<VariedFullMass<8>>> : walk_among_all<VariedQuadratic<VariedMasses<8>>>,
      8};
}
WalkClass walk_of_metric() { return {walk_among_all<VariedMetric<8>>, 8}; }
WalkClass walk_of_hamiltonian() { return {walk_among_all<VariedHamiltonian<8>>, 8}; }
WalkClass walk_of_flow() { return {walk_among_all<VariedFlow<16>>, 16}; }

}  // namespace least::variations
