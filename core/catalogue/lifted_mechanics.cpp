// lifted_splitting on equations, as text and of the catalogue, and on Hamiltonians of problems of the catalogue; the
// mechanics of Hamiltonians as text have it themselves (core/catalogue/sized_backend.cpp).
#include "core/catalogue/found_steps.hpp"
#include "core/schemes/flow_lift.hpp"
#include "core/text/lift.hpp"

namespace least {
namespace {

struct EquationsInParts {
  using Scheme = LiftedSplitting;
  using What = text::FlowParts;
  template <class T>
  using Stepper = FlowLift<T>;

  static auto look(const text::TextScene& scene, std::span<const double> parameters) {
    return text::flow_parts(*scene.form, parameters);
  }
  static auto vary(const text::Form& form, std::span<const double> parameters, std::size_t moved) {
    return text::flow_parts(form, parameters, moved);
  }
  static std::string objection(const text::FlowParts& flow, const LiftedSplitting& scheme) {
    return FlowLift<double>::objection(flow, scheme);
  }
  static void describe(const text::FlowParts& flow, ProblemCard& card) {
    card.lift = flow.linear() ? Lifted::exactly : Lifted::yes;
  }
};

/// H = S + p·X − g, on components in one contiguous list.
struct HamiltonianInParts {
  using Scheme = LiftedSplitting;
  using What = text::Lift;
  template <class T>
  class Stepper {
   public:
    Stepper(const std::shared_ptr<const text::Lift>& lift, const LiftedSplitting& scheme, std::size_t room)
        : map_(lift, scheme.composition, scheme.lift),
          room_(room),
          reads_action_(lift->reads_action),
          slope_(lift->coordinates + 1) {}
    void begin(const T* x, double t) { map_.begin(x, t, slope_.data()); }
    StepStatus step(T* x, double t, double h) noexcept {
      return map_.step({x, x + room_, reads_action_ ? x + 2 * room_ : nullptr, slope_.data()}, t, h);
    }
    Work work() const { return map_.work(); }

   private:
    LiftedMap<T> map_;
    std::size_t room_;
    bool reads_action_;
    std::vector<T> slope_;
  };

  static std::variant<text::Lift, std::string> look(const text::TextScene& scene, std::span<const double> parameters) {
    if (const auto lift = text::Lift::of(*scene.form, parameters)) return *lift;
    return text::Lift::objection(*scene.form, scene.definition.variables);
  }
  static void describe(const text::Lift& lift, ProblemCard& card) {
    card.lift = lift.linear ? Lifted::exactly : Lifted::yes;
  }
};

}  // namespace

FoundScheme lifted_splitting_found() {
  return {"lifted_splitting",
          [](const text::Form& form, bool of_catalogue) {
            return form.kind == text::FormKind::flow || (of_catalogue && form.kind == text::FormKind::hamiltonian);
          },
          [](const text::TextScene& scene, std::span<const double> parameters) {
            return scene.form->kind == text::FormKind::flow ? look_for<EquationsInParts>(scene, parameters)
                                                            : look_for<HamiltonianInParts>(scene, parameters);
          }};
}

}  // namespace least
