// A scene as text that was understood: what its author typed, its form, and its card.
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

struct TextScene {
  Definition definition;
  std::shared_ptr<const Form> form;
  int capacity = 0;  ///< degrees of freedom, or variables, of the class that computes it
  /// Of one that moves as another does backward in time (core/catalogue/backward.hpp): that one, and its card where it
  /// is a problem of the catalogue.
  std::shared_ptr<const Scene> forward{};
  std::optional<ProblemCard> known{};
  std::shared_ptr<SizedScenes> made{};  ///< of the form, with parameters
  bool acts_by_default = false;         ///< a problem of the catalogue by events of its own that act

  static std::variant<TextScene, std::vector<DefinitionFault>> read(Definition definition);
  static TextScene of(Definition definition, std::shared_ptr<const Form> form);

  /// Its card, but for what follows from the type of its mechanics. Variables beyond those of the text are hidden.
  ProblemCard described() const;
  /// p = ∂L/∂v of a scene whose Lagrangian or potential is given: `state` holds the variables of the card with
  /// velocities in the place of momenta, which they become.
  void velocities_to_momenta(std::span<const double> parameters, double t, std::vector<double>& state) const;
  /// The same for many states with the same parameters, by what `momenta` makes of these once.
  void velocities_to_momenta(const tape::Formula& momenta, double t, std::vector<double>& state) const;
  tape::Formula momenta(std::span<const double> parameters) const;
  /// The same along a direction.
  using Moved = Dual<double, 1>;
  void velocities_to_momenta(std::span<const double> parameters, const Moved& t, std::vector<Moved>& state) const;
  /// Whether the i-th variable of the card is the opposite of what its name says: momenta and s of what goes backward.
  bool turns(std::size_t i) const {
    return forward && form->kind != FormKind::flow && i >= static_cast<std::size_t>(capacity);
  }
  /// With these parameters, of a form of which there is one (SizedScene::has). Throws tape::TooManyOperations.
  std::shared_ptr<const SizedScene> sized(std::span<const double> parameters) const;
  bool takes_velocities() const { return !form->momenta.empty(); }
  /// Why no run can begin with these parameters: a mass that is not positive, a number that is not finite. Empty:
  /// nothing. `pointer`: which of the texts says so.
  struct Objection {
    std::string pointer, detail;
  };
  std::optional<Objection> objection(std::span<const double> parameters) const;
  /// The same of a start, in the order of the card: the mechanics is not finite there, ∂²L/∂v² of a Lagrangian has no
  /// inverse, or a kinetic metric is not positive definite. Where the form is natural, schemes, errors and diagnostics
  /// take K ≥ 0 for granted; of a general Lagrangian or Hamiltonian nothing is, and regular is enough.
  std::optional<Objection> objection_to_start(std::span<const double> parameters, double t,
                                              const std::vector<double>& state) const;
  /// The derived equations of motion as text: of every variable the rate, "…" where that is too long.
  using Said = std::vector<std::pair<std::string, std::string>>;
  Said equations() const;
  /// What has to be said of them; empty: nothing.
  std::string note_on_equations(const Said& equations) const;

 private:
  /// Of what is too long to be written out: the names alone.
  Said equations_in_short() const;
  /// The same of a scene that only what knows its size when it runs can tell.
  std::optional<Objection> objection_to_large_start(std::span<const double> parameters, double t,
                                                    const std::vector<double>& state) const;
  /// What the card of the catalogue says beyond the form.
  void describe_as_known(ProblemCard& card) const;
  /// The variables of the card as the form's tape numbers them.
  template <class T>
  std::vector<T> on_tape(const std::vector<T>& state) const;
  template <class T>
  void make_momenta(const tape::Formula& formula, const T& t, std::vector<T>& state) const;
  std::string not_finite_at(double t, const std::vector<double>& state) const;
  /// ∂²L/∂v² or ∂²H/∂p² in words.
  std::string second_derivative() const;
  /// What ∂²L/∂v² or ∂²H/∂p² is not at a point x, which is laid out as on the form's tape.
  std::string objection_to_masses(std::span<const double> parameters, double t, const std::vector<double>& x) const;
};

}  // namespace least::text
