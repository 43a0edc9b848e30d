// boris on scenes as text.
#include <utility>

#include "core/catalogue/found_backend.hpp"
#include "core/catalogue/found_schemes.hpp"
#include "core/schemes/boris_stepper.hpp"

namespace least {
namespace {

/// What is known of a scene with these parameters.
struct MagneticScene {
  using Scheme = Boris;
  template <class T>
  using Stepper = BorisStepper<T>;

  MagneticScene(const text::TextScene& text, std::span<const double> parameters) : scene(text, parameters) {
    auto found = text::magnetic(*text.form, parameters, text.definition.variables);
    if (auto* none = std::get_if<text::NotMagnetic>(&found)) {
      why = std::move(none->why);
    } else {
      field = std::make_shared<const text::Magnetic>(std::get<text::Magnetic>(std::move(found)));
    }
  }
  std::string objection(const Boris&) const { return why; }
  template <class T>
  BorisStepper<T> stepper(const Boris& scheme) const {
    return {field, scheme, scene.room};
  }

  SceneWithRoom scene;
  std::shared_ptr<const text::Magnetic> field;  ///< null: it has none
  std::string why;                              ///< of that
};

}  // namespace

FoundScheme boris_in_text() {
  return {"boris", [](const text::Form&) { return true; },
          [](const text::TextScene& scene, std::span<const double> parameters) {
            const auto found = text::magnetic(*scene.form, parameters, scene.definition.variables);
            const auto* none = std::get_if<text::NotMagnetic>(&found);
            return none ? none->why : std::string();
          },
          [](const text::TextScene& scene, std::span<const double> parameters) -> std::shared_ptr<const RunBackend> {
            auto found = std::make_shared<const MagneticScene>(scene, parameters);
            return std::make_shared<const FoundBackend<MagneticScene>>(std::move(found));
          }};
}

}  // namespace least
