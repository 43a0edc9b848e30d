// kepler_splitting on scenes as text.
#include "core/catalogue/found_steps.hpp"
#include "core/catalogue/planetary_stepper.hpp"

namespace least {
namespace {

struct RevolvingBodies {
  using Scheme = KeplerSplitting;
  using What = text::Planetary;
  template <class T>
  using Stepper = PlanetaryStepper<T>;

  static auto look(const text::TextScene& scene, std::span<const double> parameters) {
    return text::planetary(*scene.form, parameters, scene.definition.variables);
  }
  static std::string objection(const text::Planetary& bodies, const KeplerSplitting& scheme) {
    // Jump and kick are one part of weak forces only if they commute: attractions between the light bodies commute with
    // the jump, other forces on them do not.
    const bool heliocentric = scheme.coordinates == KeplerCoordinates::heliocentric && bodies.about_body;
    if (!scheme.turns() || !heliocentric || bodies.rest.outputs() == 0) return {};
    return "saba and aba lose their order in heliocentric coordinates where V has more than attractions; jacobi keeps "
           "it";
  }
};

}  // namespace

FoundScheme kepler_splitting_found() { return {"kepler_splitting", concerns_texts, look_for<RevolvingBodies>}; }

}  // namespace least
