#include "core/ensemble/member_starts.hpp"

#include <algorithm>

#include "core/tape/derivative.hpp"
#include "core/text/scene.hpp"
#include "core/text/start_velocities.hpp"

namespace least {
namespace {

/// momenta_vary tells whether the momenta that follow from velocities depend on a varied quantity.
bool momenta_vary(const text::TextScene& text, const Members& members) {
  const text::Form& form = *text.form;
  const auto varies = [&](int variable) -> tape::Dependence {
    return std::ranges::any_of(members.vary, [&](const Variation& varied) {
      const int place = static_cast<int>(varied.index);
      if (varied.of == Varied::parameter) return variable == form.numbers.parameter + place;
      if (varied.of == Varied::velocity) return variable == form.numbers.momentum + place;
      return variable == (varied.index < form.coordinates ? place : form.numbers.action);
    });
  };
  tape::Dependences depends(form.tape, varies);
  return std::ranges::any_of(form.momenta, [&](const Symbol& p) { return (depends(p) & 1) != 0; });
}

}  // namespace

MemberStarts::MemberStarts(const EnsemblePlan& plan) : plan_(plan) {
  const Scene& scene = *plan.request.scene;
  const text::TextScene* const text = scene.mechanics->text();
  if (!plan.members.holds_velocities || !text || !momenta_vary(*text, plan.members)) return;
  in_velocities_ = scene.initial;
  std::vector<double> velocities = plan.members.velocities;
  if (velocities.empty()) velocities = text::velocities_of(*text, scene.parameters, scene.start, scene.initial);
  std::ranges::copy(velocities, in_velocities_.begin() + text->capacity);
  if (std::ranges::none_of(plan.members.vary, &Variation::is_parameter)) momenta_ = text->momenta(scene.parameters);
}

void MemberStarts::find(std::int64_t i, std::vector<double>& parameters, std::vector<double>& initial) const {
  const Scene& scene = *plan_.request.scene;
  const text::TextScene* const text = scene.mechanics->text();
  parameters = scene.parameters;
  initial = in_velocities_.empty() ? scene.initial : in_velocities_;
  const std::vector<double> values = plan_.members.of(i);
  for (std::size_t k = 0; k < values.size(); ++k) {
    const Variation& varied = plan_.members.vary[k];
    if (varied.is_parameter())
      parameters[varied.index] = values[k];
    else
      initial[varied.of == Varied::velocity ? static_cast<std::size_t>(text->capacity) + varied.index : varied.index] =
          values[k];
  }
  if (in_velocities_.empty()) return;
  text->velocities_to_momenta(momenta_ ? *momenta_ : text->momenta(parameters), scene.start, initial);
}

std::shared_ptr<const Scene> MemberStarts::scene(std::int64_t i) const {
  auto made = std::make_shared<Scene>(*plan_.request.scene);
  find(i, made->parameters, made->initial);
  return made;
}

}  // namespace least
