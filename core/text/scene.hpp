// A scene as text that was understood: what its author typed, its form, and its card.
#pragma once

#include "core/describe.hpp"
#include "core/text/form.hpp"

namespace least::text {

struct TextScene {
  Definition definition;
  std::shared_ptr<const Form> form;
  int capacity = 0;  ///< degrees of freedom, or variables, of the class that computes it

  static std::variant<TextScene, std::vector<DefinitionFault>> read(Definition definition);

  /// Its card, but for what follows from the type of its mechanics. Variables beyond those of the text are hidden.
  ProblemCard described() const;
  /// p = ∂L/∂v of a scene whose Lagrangian is given: `state` holds the variables of the card with velocities in the
  /// place of momenta, which they become.
  void velocities_to_momenta(std::span<const double> parameters, double t, std::vector<double>& state) const;
  bool takes_velocities() const { return !form->momenta.empty(); }
  /// Why no run can begin with these parameters: a mass that is not positive, a number that is not finite. Empty:
  /// nothing. `pointer`: which of the texts says so.
  struct Objection {
    std::string pointer, detail;
  };
  std::optional<Objection> objection(std::span<const double> parameters) const;
  /// The same of a start, in the order of the card: ∂²L/∂v² of a Lagrangian has no inverse there.
  std::optional<Objection> objection_to_start(std::span<const double> parameters, double t,
                                              const std::vector<double>& state) const;
  /// The derived equations of motion as text: of every variable the rate.
  std::vector<std::pair<std::string, std::string>> equations() const;
};

}  // namespace least::text
