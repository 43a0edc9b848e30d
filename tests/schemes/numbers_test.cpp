// Every scheme with other number types, on one problem of each kind: lanes that move together, and dual parameters.
#include "core/problems/cosmological_oscillator.hpp"
#include "core/problems/double_pendulum.hpp"
#include "core/problems/kepler.hpp"
#include "core/problems/perturbed_kepler.hpp"
#include "tests/laws/lane_laws.hpp"
#include "tests/laws/number_laws.hpp"

namespace {

using namespace least;
using namespace least::problems;

TEST(Numbers, LanesPassThroughEveryScheme) {
  laws::lanes_through_schemes<Kepler, SchemeList>();
  laws::lanes_through_schemes<DoublePendulum, SchemeList>();
  laws::lanes_through_schemes<PerturbedKepler, SchemeList>();
  laws::lanes_through_schemes<CosmologicalOscillator, SchemeList>();
}
TEST(Numbers, ParametersOfEverySchemesProblemCanBeDual) {
  laws::parameters_can_be_dual<Kepler, SchemeList>();
  laws::parameters_can_be_dual<DoublePendulum, SchemeList>();
  laws::parameters_can_be_dual<PerturbedKepler, SchemeList>();
  laws::parameters_can_be_dual<CosmologicalOscillator, SchemeList>();
}

}  // namespace
