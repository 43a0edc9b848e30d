// adaptive_boris on scenes as text.
#include <mutex>
#include <utility>

#include "core/catalogue/found_steps.hpp"
#include "core/run/self_timed.hpp"
#include "core/schemes/adaptive_boris_stepper.hpp"

namespace least {
namespace {

/// PacedProblem is a problem in the form that this scheme needs.
struct PacedProblem {
  const RunBackend* backend;
};

/// PacedSteps adapts the stepper to states of a run. Each step tells its duration, and the run adds them up.
class PacedSteps {
 public:
  /// `charges` may be null: then every step fails.
  PacedSteps(const std::shared_ptr<const text::Magnetic>& charges, const AdaptiveBoris& scheme, const RunState& x,
             std::size_t room) {
    if (charges) stepper_.emplace(charges, scheme, room, x.numbers.data());
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

/// PacedScheme is the scheme with the structure found in a scene.
struct PacedScheme {
  AdaptiveBoris chosen;
  std::shared_ptr<const text::Magnetic> charges;
  std::string why;  ///< why there are no charges; empty if there are
  std::size_t room;
  bool starts;  ///< whether the pace is defined at the start of the run

  static constexpr bool own_clock = true, remembers = true, asks_no_level = true;
  PacedSteps bind(const PacedProblem&, const RunState& x, double) const { return {charges, chosen, x, room}; }
  std::string unsupported_reason(const PacedProblem&, double) const {
    if (!why.empty()) return AdaptiveBoris::card().id + " does not run this scene with these parameters: " + why;
    if (!starts) return "nothing at the start says how fast the motion is: neither a force nor a field changes there";
    return {};
  }
};

using Charges = std::variant<text::Magnetic, text::NotMagnetic>;

Charges charges_in(const text::Form& form, std::span<const double> parameters, std::span<const std::string> names) {
  if (!form.autonomous && form.kind == text::FormKind::hamiltonian) return text::NotMagnetic{"H depends on time"};
  return text::magnetic(form, parameters, names);
}

class PacedCharges final : public FoundOrNot<text::Magnetic> {
 public:
  PacedCharges(const text::TextScene& scene, std::span<const double> parameters)
      : FoundOrNot(charges_in(*scene.form, parameters, scene.definition.variables)),
        form_(scene.form),
        names_(scene.definition.variables),
        parameters_(parameters.begin(), parameters.end()) {}

  std::unique_ptr<Integrator> bind(const RunBackend& problem, const Request& request, const RunState& x, const Grid&,
                                   double end) const override {
    const auto chosen = from_values<AdaptiveBoris>(AdaptiveBoris::fields, request.settings);
    std::call_once(paced_once_, [&] { look_for_pace(); });
    const std::size_t room = problem.table().traits.dof;
    const bool starts = PacedSteps(paced_, chosen, x, room).has_pace();
    return std::make_unique<SelfTimedIntegrator<PacedProblem, PacedScheme, RunState>>(
        problem, PacedProblem{&problem}, PacedScheme{chosen, paced_, why_, room, starts}, x, end);
  }
  StepTangents tangents(const RunBackend&, const Request&) const override { return {}; }

 private:
  /// Also finds how fast everything changes along a motion, which takes derivatives up to the third: only once a run
  /// asks for it.
  void look_for_pace() const {
    why_ = objection();
    if (!why_.empty()) return;
    auto found = text::magnetic(*form_, parameters_, names_, text::Pace::yes);
    if (auto* none = std::get_if<text::NotMagnetic>(&found))
      why_ = std::move(none->why);
    else
      paced_ = std::make_shared<const text::Magnetic>(std::get<text::Magnetic>(std::move(found)));
  }

  std::shared_ptr<const text::Form> form_;
  std::vector<std::string> names_;
  std::vector<double> parameters_;
  mutable std::once_flag paced_once_;
  mutable std::shared_ptr<const text::Magnetic> paced_;
  mutable std::string why_;
};

}  // namespace

FoundScheme adaptive_boris_found() {
  return {"adaptive_boris", concerns_texts,
          [](const text::TextScene& scene, std::span<const double> parameters) -> std::shared_ptr<const Found> {
            return std::make_shared<const PacedCharges>(scene, parameters);
          }};
}

}  // namespace least
