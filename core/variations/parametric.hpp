// The equations of motion of any scene with its parameters as variables, from which derivatives by parameters are made.
// All mechanics are contact Hamiltonian here, H(q, p, s, t; θ): q̇ = H_p, ṗ = −H_q − p H_s, ṡ = p·H_p − H.
// Source: Bravetti, Entropy 19, 535 (2017), eq. 43.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/run/mechanics.hpp"
#include "core/tape/program.hpp"
#include "core/text/form.hpp"

namespace least::variations {

/// ParametricScene holds these equations on one tape. Its variables are the components of the state (q, p, and s where
/// the motion or who asks needs it; of a flow, its variables), then the parameters in the order of the card. Shared and
/// immutable once it is made; not movable, as its symbols point to its tape.
struct ParametricScene {
  ParametricScene() = default;
  ParametricScene(const ParametricScene&) = delete;
  ParametricScene& operator=(const ParametricScene&) = delete;

  std::shared_ptr<const text::Form> form;  ///< the form from which the equations are written
  tape::Tape tape;
  std::size_t components = 0, coordinates = 0;  ///< coordinates: 0 of a flow
  bool acting = false;                          ///< s is a component
  bool forced = false;                          ///< forces act beside the mechanics
  std::vector<std::size_t> variables;           ///< by component: its index among the card's variables
  std::vector<double> parameters;               ///< in the order of the card
  std::vector<Symbol> rates;                    ///< by component
  /// Where available, the programs of the scheme `taylor`: with numbers for all parameters, and with the `varied`
  /// parameters as variables of rate 0.
  std::optional<tape::Program> motion, varied_motion;
  std::vector<bool> varied;  ///< by parameter, whether derivatives by it are asked for
  Symbol energy;        ///< H, where the mechanics has one that depends on the components alone; else the constant NaN
  Symbol action_slope;  ///< H_s of mechanics
  /// where a start may give velocities: p as functions of the state with velocities in the place of p
  std::vector<Symbol> momenta;
  /// By component: −1 where it is the opposite of the card's variable (a time-reversed scene)
  std::vector<double> signs;
  bool backward = false;  ///< the scene is time-reversed: so is its time
  double sign_of_time() const { return backward ? -1 : 1; }
};

/// parametric_scene returns the equations of a scene, or why it has none. Only parameters marked in `varied` may be
/// varied. `with_action`: s is a component of every contact scene, also where the motion does not need it. Throws
/// tape::TooManyOperations.
std::variant<std::shared_ptr<const ParametricScene>, std::string> parametric_scene(const Scene& scene,
                                                                                   const std::vector<bool>& varied,
                                                                                   bool with_action = false);

}  // namespace least::variations
