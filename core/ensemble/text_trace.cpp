#include "core/ensemble/step_tracer.hpp"
#include "core/text/scene.hpp"
#include "core/text/scenes.hpp"

namespace least {

std::optional<StepTrace> trace_text(const Request& request, std::span<const double> parameters, std::size_t scheme,
                                    bool full) {
  using text::FormKind;
  const text::TextScene& text = *request.scene->mechanics->text();
  const text::Form& form = *text.form;
  if (!form.is_compiled() || form.kind == FormKind::lagrangian) return std::nullopt;
  const auto formulas = std::make_shared<const text::Formulas>(form, parameters);
  std::optional<StepTrace> made(std::in_place);
  const auto as = [&]<class P>(P*) {
    P problem;
    problem.formulas = formulas;
    StepTracer<P> tracer(request, problem, static_cast<std::size_t>(text.capacity), full, *made);
    bool good = false;
    with_lane_scheme(scheme, request.settings, [&](const auto& s) { good = tracer.trace_steps(s, s.step); });
    if (!good) made.reset();
  };
  // Forms that lead to the same class are traced alike.
  constexpr int n = text::compiled_coordinates;
  if (form.kind == FormKind::separable) as(static_cast<text::SeparableScene<n>*>(nullptr));
  if (form.kind == FormKind::contact_linear && form.constant_damping) as(static_cast<text::DampedScene<n>*>(nullptr));
  if (form.kind == FormKind::contact_linear && !form.constant_damping)
    as(static_cast<text::TimedDampedScene<n>*>(nullptr));
  if (form.kind == FormKind::contact_quadratic) as(static_cast<text::QuadraticScene<n>*>(nullptr));
  if (form.kind == FormKind::metric) as(static_cast<text::MetricScene<n>*>(nullptr));
  if (form.kind == FormKind::hamiltonian) as(static_cast<text::HamiltonianScene*>(nullptr));
  if (form.kind == FormKind::flow) as(static_cast<text::FlowScene*>(nullptr));
  return made;
}

}  // namespace least
