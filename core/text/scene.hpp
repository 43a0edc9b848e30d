// A scene given as text, once it was understood: what its author typed, its form, and its card.
#pragma once

#include <memory>
#include <optional>

#include "core/describe.hpp"
#include "core/number/dual.hpp"
#include "core/text/form.hpp"

namespace least {
struct Scene;
}

namespace least::tape {
class Formula;
}

namespace least::text {

class SizedScene;
class SizedScenes;

/// TextScene is a definition together with its form and its parametrized mechanics.
struct TextScene {
  Definition definition;
  std::shared_ptr<const Form> form;
  int capacity = 0;  ///< degrees of freedom, or variables of a flow, that a state of the card has
  /// Only of a scene that is the time reversal of another one (core/catalogue/backward.hpp): that other scene, and its
  /// card where it is a problem of the catalogue.
  std::shared_ptr<const Scene> forward{};
  std::optional<ProblemCard> known{};
  std::shared_ptr<SizedScenes> made{};  ///< caches the last SizedScene made of `form`
  bool acts_by_default = false;         ///< a problem of the catalogue whose own default events act on the motion

  static std::variant<TextScene, std::vector<DefinitionFault>> read(Definition definition);
  static TextScene of(Definition definition, std::shared_ptr<const Form> form);

  /// described() returns the card, without what follows from the type of the mechanics. Variables beyond those of the
  /// text are hidden.
  ProblemCard described() const;
  /// velocities_to_momenta sets p = ∂L/∂v in a scene whose Lagrangian or potential is given: `state` has the order of
  /// the card's variables, with velocities in the place of momenta, and is converted in place.
  void velocities_to_momenta(std::span<const double> parameters, double t, std::vector<double>& state) const;
  /// The overload with a formula serves many states with the same parameters; momenta(parameters) makes the formula.
  void velocities_to_momenta(const tape::Formula& momenta, double t, std::vector<double>& state) const;
  tape::Formula momenta(std::span<const double> parameters) const;
  /// The overload with dual numbers carries a derivative along one direction.
  using Moved = Dual<double, 1>;
  void velocities_to_momenta(std::span<const double> parameters, const Moved& t, std::vector<Moved>& state) const;
  /// turns(i) tells whether the i-th variable of the card has the opposite sign of what its name says: momenta and s of
  /// a time-reversed scene.
  bool turns(std::size_t i) const {
    return forward && form->kind != FormKind::flow && i >= static_cast<std::size_t>(capacity);
  }
  /// sized(parameters) returns the mechanics with these parameters, of a form with SizedScene::has(form). Throws
  /// tape::TooManyOperations.
  std::shared_ptr<const SizedScene> sized(std::span<const double> parameters) const;
  bool takes_velocities() const { return !form->momenta.empty(); }
  /// Objection is why no run can begin: `pointer` is the text that is at fault, `detail` says how.
  /// objection(parameters) finds a mass that is not positive, or a number that is not finite; nothing where all is
  /// well.
  struct Objection {
    std::string pointer, detail;
  };
  std::optional<Objection> objection(std::span<const double> parameters) const;
  /// objection_to_start checks a start, in the order of the card: the mechanics is not finite there, ∂²L/∂v² of a
  /// Lagrangian has no inverse, or a kinetic metric is not positive definite. Schemes, errors and diagnostics of
  /// natural forms assume K ≥ 0; general Lagrangians and Hamiltonians need only be regular.
  std::optional<Objection> objection_to_start(std::span<const double> parameters, double t,
                                              const std::vector<double>& state) const;
  /// equations() returns the derived equations of motion as (variable, text of its rate); "…" where the rate is too
  /// long.
  using Said = std::vector<std::pair<std::string, std::string>>;
  Said equations() const;
  /// note_on_equations returns a remark to be shown with them; empty where there is none.
  std::string note_on_equations(const Said& equations) const;

 private:
  /// The names alone, for equations that are too long to be written out.
  Said equations_in_short() const;
  /// objection_to_start of a scene that is not compiled (Form::is_compiled).
  std::optional<Objection> objection_to_large_start(std::span<const double> parameters, double t,
                                                    const std::vector<double>& state) const;
  /// Adds to the card what the card of the catalogue says beyond the form.
  void describe_as_known(ProblemCard& card) const;
  /// on_tape returns a state of the card in the numbering of the form's tape.
  template <class T>
  std::vector<T> on_tape(const std::vector<T>& state) const;
  template <class T>
  void make_momenta(const tape::Formula& formula, const T& t, std::vector<T>& state) const;
  std::string not_finite_at(double t, const std::vector<double>& state) const;
  /// second_derivative returns "∂²L/∂v²" or "∂²H/∂p²" as the messages name it.
  std::string second_derivative() const;
  /// objection_to_masses says what ∂²L/∂v² or ∂²H/∂p² lacks at x, which has the numbering of the form's tape.
  std::string objection_to_masses(std::span<const double> parameters, double t, const std::vector<double>& x) const;
};

}  // namespace least::text
