#include "core/variations/scheme_map.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/catalogue/found_schemes.hpp"

namespace least::variations {
namespace {

WalkClass class_of(const text::Form& form) {
  using text::FormKind;
  if (!form.is_compiled()) {
    const bool sized = form.kind != FormKind::contact_quadratic && form.kind != FormKind::metric;
    return sized && form.kind != FormKind::lagrangian ? walk_of_large(form) : WalkClass{};
  }
  switch (form.kind) {
    case FormKind::separable:
      return walk_of_separable(form.full_mass);
    case FormKind::contact_linear:
      return walk_of_damped(form.full_mass, form.constant_damping);
    case FormKind::contact_quadratic:
      return walk_of_quadratic(form.full_mass);
    case FormKind::metric:
      return walk_of_metric();
    case FormKind::hamiltonian:
      return walk_of_hamiltonian();
    case FormKind::flow:
      return walk_of_flow();
    case FormKind::lagrangian:
      return {};
  }
  return {};
}

bool has_class(const SchemeCard& scheme, const text::Form& form) {
  const WalkClass by = form.forced ? WalkClass() : class_of(form);
  return by.walk && form.coordinates <= by.room && by.walk(nullptr, scheme.id, nullptr);
}

/// For a scheme that works with structures found in a scene (such as planetary or magnetic terms).
Walked walk_by_what_was_found(const Walk& on, const ParametricScene& equations, std::optional<std::size_t> moved) {
  Walked made;
  const std::size_t size = on.start.size();
  std::vector<Slope> y;
  for (std::size_t i = 0; i < size; ++i) y.push_back(Slope{on.start[i], {on.slope[i]}});
  std::optional<Found::Moved> parameter;
  if (moved) {
    parameter.emplace(Found::Moved{*equations.form, equations.parameters, *moved});
    y.push_back(Slope{equations.parameters[*moved], {1}});
  }
  const auto found = found_in(*on.request.scene, on.scheme.id);
  const auto stepper = found->with_slopes(on.request, equations.coordinates, parameter ? &*parameter : nullptr);
  stepper->begin(y.data(), on.grid.start);
  const auto look = [&] {
    auto& state = made.states.emplace_back();
    auto& slope = made.slopes.emplace_back();
    for (std::size_t i = 0; i < size; ++i) {
      state.push_back(y[i].value);
      slope.push_back(y[i].slope[0]);
    }
  };
  made.reason = go_over(on, look, [&](double t, double h) { return stepper->step(y.data(), t, h); });
  return made;
}

}  // namespace

Walked walk(const Walk& on, const ParametricScene& equations, std::optional<std::size_t> moved) {
  if (!has_class(on.scheme, *equations.form)) return walk_by_what_was_found(on, equations, moved);
  const WalkClass by = class_of(*equations.form);
  auto formulas = std::make_shared<const VariedFormulas>(*equations.form, equations.parameters, moved, by.room);
  return *by.walk(&on, on.scheme.id, formulas);
}

std::string no_walk(const Scene& scene, const SchemeCard& scheme, const ParametricScene& equations,
                    const std::vector<Quantity>& by) {
  if (has_class(scheme, *equations.form)) return {};
  const auto found = found_in(scene, scheme.id);
  if (!found || !found->has_slopes(false))
    return fmt::format("of the map of {} on this scene there is no derivative", scheme.id);
  const auto of_scene = [](const Quantity& quantity) { return quantity.kind == Quantity::Kind::parameter; };
  if (found->has_slopes(true) || std::ranges::none_of(by, of_scene)) return {};
  return fmt::format("of the map of {} there is no derivative by parameters, by the start alone", scheme.id);
}

}  // namespace least::variations
