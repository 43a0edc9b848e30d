// adaptive_boris on scenes as text.
#include <utility>

#include "core/catalogue/found_backend.hpp"
#include "core/catalogue/found_schemes.hpp"
#include "core/run/self_timed.hpp"
#include "core/schemes/adaptive_boris_stepper.hpp"

namespace least {
namespace {

/// What is known of a scene with these parameters.
struct PacedScene {
  PacedScene(const text::TextScene& text, std::span<const double> parameters) : scene(text, parameters) {
    auto found = text::magnetic(*text.form, parameters, text.definition.variables, text::Pace::yes);
    if (auto* none = std::get_if<text::NotMagnetic>(&found)) {
      why = std::move(none->why);
    } else {
      field = std::make_shared<const text::Magnetic>(std::get<text::Magnetic>(std::move(found)));
    }
  }

  SceneWithRoom scene;
  std::shared_ptr<const text::Magnetic> field;  ///< null: it has none
  std::string why;                              ///< of that
};

/// A problem as schemes see it here: what a run asks of it.
struct PacedProblem {
  const RunBackend* backend;
};

/// The stepper on states of a run. A run says of its steps how long they took.
class PacedSteps {
 public:
  PacedSteps(const PacedScene& scene, const AdaptiveBoris& scheme, const RunState& x) {
    if (scene.field) stepper_.emplace(scene.field, scheme, scene.scene.room, x.numbers.data());
  }
  StepStatus step(RunState& x) noexcept {
    if (!stepper_ || !stepper_->has_pace()) return StepStatus::singular;
    double elapsed = 0;
    const StepStatus status = stepper_->advance(x.numbers.data(), elapsed);
    x.t += elapsed;
    return status;
  }
  StepStatus reach(RunState& x, double time) noexcept {
    if (!stepper_ || !stepper_->has_pace()) return StepStatus::singular;
    const double ahead = time - x.t;
    x.t = time;
    return stepper_->reach(x.numbers.data(), ahead);
  }
  Work work() const { return stepper_ ? stepper_->work() : Work(); }
  AdaptiveBorisStepper::Memory memory() const { return stepper_ ? stepper_->memory() : AdaptiveBorisStepper::Memory(); }
  void resume(const RunState&, const AdaptiveBorisStepper::Memory& memory) {
    if (stepper_) stepper_->resume(memory);
  }
  bool has_pace() const { return stepper_ && stepper_->has_pace(); }

 private:
  std::optional<AdaptiveBorisStepper> stepper_;
};

/// The scheme, bound to a scene.
struct PacedScheme {
  AdaptiveBoris chosen;
  std::shared_ptr<const PacedScene> scene;
  bool starts;  ///< the start of the run has a pace

  static constexpr bool own_clock = true, remembers = true, asks_no_level = true;
  PacedSteps bind(const PacedProblem&, const RunState& x, double) const { return {*scene, chosen, x}; }
  std::string unsupported_reason(const PacedProblem&, double) const {
    if (!scene->why.empty())
      return AdaptiveBoris::card().id + " does not run this scene with these parameters: " + scene->why;
    if (!starts) return "nothing at the start says how fast the motion is: neither a force nor a field changes there";
    return {};
  }
};

class PacedBackend final : public SizedBackend {
 public:
  explicit PacedBackend(std::shared_ptr<const PacedScene> scene)
      : SizedBackend(scene->scene.sized), scene_(std::move(scene)) {}

  std::unique_ptr<Integrator> bind(const Request& request, const RunState& x, const Grid&, double end) const override {
    const auto chosen = from_values<AdaptiveBoris>(AdaptiveBoris::fields, request.settings);
    const PacedScheme scheme{chosen, scene_, PacedSteps(*scene_, chosen, x).has_pace()};
    return std::make_unique<SelfTimedIntegrator<PacedProblem, PacedScheme, RunState>>(*this, PacedProblem{this}, scheme,
                                                                                      x, end);
  }
  bool has_component(std::size_t i) const override { return scene_->scene.has_component(i); }

 private:
  std::shared_ptr<const PacedScene> scene_;
};

}  // namespace

FoundScheme adaptive_boris_in_text() {
  return {"adaptive_boris", [](const text::Form&) { return true; },
          [](const text::TextScene& scene, std::span<const double> parameters) {
            if (!scene.form->autonomous && scene.form->kind == text::FormKind::hamiltonian)
              return std::string("H depends on time");
            const auto found = text::magnetic(*scene.form, parameters, scene.definition.variables);
            const auto* none = std::get_if<text::NotMagnetic>(&found);
            return none ? none->why : std::string();
          },
          [](const text::TextScene& scene, std::span<const double> parameters) -> std::shared_ptr<const RunBackend> {
            return std::make_shared<const PacedBackend>(std::make_shared<const PacedScene>(scene, parameters));
          }};
}

}  // namespace least
