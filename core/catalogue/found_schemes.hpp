// Schemes that need a special structure of the mechanics, which is searched in the text of a scene, or in a recorded
// problem of the catalogue. Their steps are made of the structure that was found; everything else that a run needs is
// that of the scene.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "core/run/backend.hpp"
#include "core/run/mechanics.hpp"
#include "core/text/scene.hpp"

namespace least {

/// SlopedSteps are steps in dual numbers: the slopes are derivatives of the scheme's own map.
class SlopedSteps {
 public:
  virtual ~SlopedSteps() = default;
  virtual void begin(const Slope* x, double t) = 0;
  virtual StepStatus step(Slope* x, double t, double h) = 0;
};

/// Found is the structure that such a scheme found in a scene with certain parameters, and makes the steps there.
class Found {
 public:
  virtual ~Found() = default;
  /// Why the scene lacks the structure, in words; empty: it has it. With an objection no step succeeds.
  virtual std::string objection() const = 0;
  /// Adds what was found to the card of the scene.
  virtual void describe(ProblemCard&) const {}
  /// Steps of the scheme and their tangents, as in RunBackend. `problem` provides everything but the steps.
  virtual std::unique_ptr<Integrator> bind(const RunBackend& problem, const Request& request, const RunState& x,
                                           const Grid& grid, double end) const = 0;
  virtual StepTangents tangents(const RunBackend& problem, const Request& request) const = 0;
  /// with_slopes returns steps in dual numbers on states with places for `room` coordinates, null if has_slopes is
  /// false. With `Moved` also the derivative by a parameter of the scene, which then is a variable after the state.
  struct Moved {
    const text::Form& form;  ///< the form of the scene with its parameters as variables
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
  /// Whether this scheme is searched in scenes of such a form, as text or (`of_catalogue`) recorded; the classes of
  /// other scenes decide themselves.
  bool (*concerns)(const text::Form& form, bool of_catalogue);
  std::shared_ptr<const Found> (*look)(const text::TextScene& scene, std::span<const double> parameters);
};

inline bool concerns_texts(const text::Form&, bool of_catalogue) { return !of_catalogue; }

// All such schemes.
FoundScheme kepler_splitting_found();
FoundScheme boris_found();
FoundScheme adaptive_boris_found();
FoundScheme harmonic_splitting_found();
FoundScheme lifted_splitting_found();

/// with_found_schemes returns the same mechanics with every such scheme that finds its structure in the scene.
std::shared_ptr<const Mechanics> with_found_schemes(std::shared_ptr<const Mechanics> made);

/// found_in returns what this scheme finds in the scene with its parameters; null if it finds nothing, or is not such a
/// scheme.
std::shared_ptr<const Found> found_in(const Scene& scene, std::string_view scheme);
/// objection_to_scheme returns in words why such a scheme does not run this scene with its parameters; empty if it
/// does, or is not such a scheme.
std::string objection_to_scheme(const Scene& scene, std::string_view scheme);

}  // namespace least
