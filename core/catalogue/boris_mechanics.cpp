// boris on scenes as text.
#include "core/catalogue/found_steps.hpp"
#include "core/schemes/boris_stepper.hpp"

namespace least {
namespace {

struct ChargesInAField {
  using Scheme = Boris;
  using What = text::Magnetic;
  template <class T>
  using Stepper = BorisStepper<T>;

  static auto look(const text::TextScene& scene, std::span<const double> parameters) {
    return text::magnetic(*scene.form, parameters, scene.definition.variables);
  }
};

}  // namespace

FoundScheme boris_found() { return {"boris", concerns_texts, look_for<ChargesInAField>}; }

}  // namespace least
