// kepler_splitting on scenes as text.
#include <utility>

#include "core/catalogue/found_backend.hpp"
#include "core/catalogue/found_schemes.hpp"
#include "core/catalogue/planetary_stepper.hpp"

namespace least {
namespace {

using Found = std::variant<text::Planetary, text::NotPlanetary>;

Found bodies_in(const text::TextScene& scene, std::span<const double> parameters) {
  return text::planetary(*scene.form, parameters, scene.definition.variables);
}

/// What is known of a scene with these parameters.
struct PlanetaryScene {
  using Scheme = KeplerSplitting;
  template <class T>
  using Stepper = PlanetaryStepper<T>;

  PlanetaryScene(const text::TextScene& text, std::span<const double> parameters) : scene(text, parameters) {
    auto found = bodies_in(text, parameters);
    if (auto* none = std::get_if<text::NotPlanetary>(&found)) {
      why = std::move(none->why);
    } else {
      bodies = std::make_shared<const text::Planetary>(std::get<text::Planetary>(std::move(found)));
    }
  }
  std::string objection(const KeplerSplitting& scheme) const {
    if (!bodies) return why;
    // Jump and kick make one part of weak forces only where they commute: a force on all light bodies alike is none.
    const bool heliocentric = scheme.coordinates == KeplerCoordinates::heliocentric && bodies->about_body;
    if (!scheme.turns() || !heliocentric || bodies->rest.outputs() == 0) return {};
    return "saba and aba lose their order in heliocentric coordinates where V has more than attractions; jacobi keeps "
           "it";
  }
  template <class T>
  PlanetaryStepper<T> stepper(const KeplerSplitting& scheme) const {
    return {bodies, scheme, scene.room};
  }

  SceneWithRoom scene;
  std::shared_ptr<const text::Planetary> bodies;  ///< null: it has none
  std::string why;                                ///< of that
};

}  // namespace

FoundScheme kepler_splitting_in_text() {
  return {"kepler_splitting", [](const text::Form&) { return true; },
          [](const text::TextScene& scene, std::span<const double> parameters) {
            const auto found = bodies_in(scene, parameters);
            const auto* none = std::get_if<text::NotPlanetary>(&found);
            return none ? none->why : std::string();
          },
          [](const text::TextScene& scene, std::span<const double> parameters) -> std::shared_ptr<const RunBackend> {
            auto found = std::make_shared<const PlanetaryScene>(scene, parameters);
            return std::make_shared<const FoundBackend<PlanetaryScene>>(std::move(found));
          }};
}

}  // namespace least
