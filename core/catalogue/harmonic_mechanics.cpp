// harmonic_splitting on scenes as text.
#include <utility>

#include "core/catalogue/found_backend.hpp"
#include "core/catalogue/found_schemes.hpp"
#include "core/schemes/harmonic_stepper.hpp"

namespace least {
namespace {

/// What is known of a scene with these parameters.
struct OscillatorsScene {
  using Scheme = HarmonicSplitting;
  template <class T>
  using Stepper = HarmonicStepper<T>;

  OscillatorsScene(const text::TextScene& text, std::span<const double> parameters) : scene(text, parameters) {
    auto found = text::harmonic(*text.form, parameters);
    if (auto* none = std::get_if<std::string>(&found)) {
      why = std::move(*none);
    } else {
      oscillators = std::make_shared<const text::Harmonic>(std::get<text::Harmonic>(std::move(found)));
    }
  }
  std::string objection(const HarmonicSplitting&) const { return why; }
  template <class T>
  HarmonicStepper<T> stepper(const HarmonicSplitting& scheme) const {
    return {oscillators, scheme, scene.room};
  }

  SceneWithRoom scene;
  std::shared_ptr<const text::Harmonic> oscillators;  ///< null: it has none
  std::string why;                                    ///< of that
};

}  // namespace

FoundScheme harmonic_splitting_in_text() {
  return {"harmonic_splitting", [](const text::Form&) { return true; },
          [](const text::TextScene& scene, std::span<const double> parameters) {
            const auto found = text::harmonic(*scene.form, parameters);
            const auto* none = std::get_if<std::string>(&found);
            return none ? *none : std::string();
          },
          [](const text::TextScene& scene, std::span<const double> parameters) -> std::shared_ptr<const RunBackend> {
            auto found = std::make_shared<const OscillatorsScene>(scene, parameters);
            return std::make_shared<const FoundBackend<OscillatorsScene>>(std::move(found));
          }};
}

}  // namespace least
