// Schemes that are found in the mechanics of a scene as it was typed, whatever class it is of, or as a problem of the
// catalogue is recorded: steps are made of what was found, and all else that a run asks is the scene's own.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "core/run/backend.hpp"
#include "core/run/mechanics.hpp"
#include "core/text/scene.hpp"

namespace least {

/// Steps that carry a direction along: their slopes are the derivatives of the scheme's own map.
class SlopedSteps {
 public:
  virtual ~SlopedSteps() = default;
  virtual void begin(const Slope* x, double t) = 0;
  virtual StepStatus step(Slope* x, double t, double h) = 0;
};

/// What such a scheme finds in a scene with some parameters, and its steps there.
class Found {
 public:
  virtual ~Found() = default;
  /// Why the scene has not what the scheme needs, in words; empty: it has. Else no step succeeds.
  virtual std::string objection() const = 0;
  /// What the card of the scene says more.
  virtual void describe(ProblemCard&) const {}
  /// Steps of the scheme, as those of RunBackend. `problem`: all that is not a step.
  virtual std::unique_ptr<Integrator> bind(const RunBackend& problem, const Request& request, const RunState& x,
                                           const Grid& grid, double end) const = 0;
  virtual StepTangents tangents(const RunBackend& problem, const Request& request) const = 0;
  /// Steps for derivatives, where it has them, on states with places for `room` coordinates; by a parameter of the
  /// scene as well, where that moves and stands after the state.
  struct Moved {
    const text::Form& form;  ///< with its parameters as variables
    std::span<const double> parameters;
    std::size_t which;
  };
  virtual bool has_slopes(bool /*by_parameter*/) const { return false; }
  virtual std::unique_ptr<SlopedSteps> with_slopes(const Request&, std::size_t /*room*/, const Moved*) const {
    return nullptr;
  }
};

struct FoundScheme {
  std::string_view id;
  /// Whether scenes of such a form are asked at all, those that are typed or problems of the catalogue; of others their
  /// classes know.
  bool (*concerns)(const text::Form& form, bool of_catalogue);
  std::shared_ptr<const Found> (*look)(const text::TextScene& scene, std::span<const double> parameters);
};

inline bool concerns_texts(const text::Form&, bool of_catalogue) { return !of_catalogue; }

// All of them.
FoundScheme kepler_splitting_found();
FoundScheme boris_found();
FoundScheme adaptive_boris_found();
FoundScheme harmonic_splitting_found();
FoundScheme lifted_splitting_found();

/// The same mechanics, with every such scheme where the scene has what that needs.
std::shared_ptr<const Mechanics> with_found_schemes(std::shared_ptr<const Mechanics> made);

/// What it finds in this one, with its parameters; null: it is another kind of scheme or scene, or there is nothing.
std::shared_ptr<const Found> found_in(const Scene& scene, std::string_view scheme);
/// What a scheme that is found in scenes has against this one, with its parameters, in words; empty: nothing, or it is
/// another kind of scheme or scene.
std::string objection_to_scheme(const Scene& scene, std::string_view scheme);

}  // namespace least
