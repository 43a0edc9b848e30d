// Schemes that are found in the text of a scene, whatever class it is of: runs by them take the scene as one whose size
// is known when it runs, and everything else is that of its class.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "core/run/backend.hpp"
#include "core/run/mechanics.hpp"
#include "core/text/scene.hpp"

namespace least {

/// What such a scheme looks for in a text.
struct FoundScheme {
  std::string_view id;
  /// Whether scenes of such a form are asked at all; of others their classes know.
  bool (*concerns)(const text::Form& form);
  /// Why a scene has not what the scheme needs, with these parameters, in words; empty: it has.
  std::string (*objection)(const text::TextScene& scene, std::span<const double> parameters);
  /// What a run asks of a scene with these parameters. Where it has not what is needed no step succeeds.
  std::shared_ptr<const RunBackend> (*backend)(const text::TextScene& scene, std::span<const double> parameters);
  /// What the card of a scene says more where it has it; null: nothing.
  void (*describe)(const text::TextScene& scene, std::span<const double> parameters, ProblemCard& card) = nullptr;
};

// All of them.
FoundScheme kepler_splitting_in_text();
FoundScheme boris_in_text();
FoundScheme adaptive_boris_in_text();
FoundScheme harmonic_splitting_in_text();
FoundScheme lifted_splitting_in_equations();

/// The same mechanics, with every such scheme where the text has what that needs.
std::shared_ptr<const Mechanics> with_found_schemes(std::shared_ptr<const Mechanics> made);

/// What a scheme that is found in the text of a scene has against this one, with its parameters, in words; empty:
/// nothing, or it is another kind of scheme or scene.
std::string objection_to_scheme(const Scene& scene, std::string_view scheme);

}  // namespace least
