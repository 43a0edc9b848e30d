// lifted_splitting on equations given as text.
#include <utility>

#include "core/catalogue/found_backend.hpp"
#include "core/catalogue/found_schemes.hpp"
#include "core/schemes/flow_lift.hpp"

namespace least {
namespace {

/// What is known of equations with these parameters.
struct FlowInParts {
  using Scheme = LiftedSplitting;
  template <class T>
  using Stepper = FlowLift<T>;

  FlowInParts(const text::TextScene& text, std::span<const double> parameters) : scene(text, parameters) {
    auto found = text::flow_parts(*text.form, parameters);
    if (auto* none = std::get_if<std::string>(&found)) {
      why = std::move(*none);
    } else {
      flow = std::make_shared<const text::FlowParts>(std::get<text::FlowParts>(std::move(found)));
    }
  }
  std::string objection(const LiftedSplitting& scheme) const {
    return flow ? FlowLift<double>::objection(*flow, scheme) : why;
  }
  template <class T>
  FlowLift<T> stepper(const LiftedSplitting& scheme) const {
    return {flow, scheme};
  }

  SceneWithRoom scene;
  std::shared_ptr<const text::FlowParts> flow;  ///< null: it has none
  std::string why;                              ///< of that
};

}  // namespace

FoundScheme lifted_splitting_in_equations() {
  return {"lifted_splitting", [](const text::Form& form) { return form.kind == text::FormKind::flow; },
          [](const text::TextScene& scene, std::span<const double> parameters) {
            const auto found = text::flow_parts(*scene.form, parameters);
            const auto* none = std::get_if<std::string>(&found);
            return none ? *none : std::string();
          },
          [](const text::TextScene& scene, std::span<const double> parameters) -> std::shared_ptr<const RunBackend> {
            auto found = std::make_shared<const FlowInParts>(scene, parameters);
            return std::make_shared<const FoundBackend<FlowInParts>>(std::move(found));
          }};
}

}  // namespace least
