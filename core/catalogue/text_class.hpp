// Schemes that are compiled for classes of scenes as text, with room for so many coordinates: those that have no steps
// for scenes of any size. Everything else of such a scene is as of any size (core/catalogue/sized_mechanics.cpp).
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "core/run/integrator.hpp"
#include "core/text/form.hpp"

namespace least {

namespace text {
struct Formulas;
}

struct TextClass {
  using Formulas = std::shared_ptr<const text::Formulas>;

  std::string_view name;               ///< as `damped_2`: of a form, with room for so many coordinates
  std::vector<std::size_t> schemes{};  ///< positions in the list of schemes
  std::unique_ptr<Integrator> (*bind)(const RunBackend& backend, const Formulas& formulas, const Request& request,
                                      const RunState& x, const Grid& grid, double end) = nullptr;
  StepTangents (*tangents)(const Formulas& formulas, const Request& request) = nullptr;

  bool has(std::size_t scheme) const;
};

/// The class for a form; null where there is none, or this build leaves it out.
const TextClass* text_class_of(const text::Form& form);
/// Those of this build.
std::span<const TextClass> text_classes();

/// Where the components of a scene with n coordinates stand among those of a state with room for more: q, p, and s.
std::vector<std::size_t> places_in(std::size_t n, std::size_t room, bool acting);
/// The same tangents; what they refer to lives as long as they do.
StepTangents keeping(std::shared_ptr<const void> owner, StepTangents tangents);
/// Tangents of a problem with room for `room` coordinates as those of a scene that has n.
StepTangents without_room(StepTangents roomy, std::size_t n, std::size_t room, bool acting);

}  // namespace least
