#include "core/variations/scheme_map.hpp"

#include <fmt/format.h>

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

}  // namespace

Walked walk(const Walk& on, const text::Form& form, std::span<const double> parameters,
            std::optional<std::size_t> moved) {
  const WalkClass by = class_of(form);
  const SchemeCard& scheme = on.scheme;
  auto formulas = std::make_shared<const VariedFormulas>(form, parameters, moved, by.room);
  return *by.walk(&on, scheme.id, formulas);
}

std::string no_walk(const SchemeCard& scheme, const text::Form& form) {
  const WalkClass by = form.forced ? WalkClass() : class_of(form);
  if (by.walk && form.coordinates <= by.room && by.walk(nullptr, scheme.id, nullptr)) return {};
  return fmt::format("of the map of {} on this scene there is no derivative", scheme.id);
}

}  // namespace least::variations
