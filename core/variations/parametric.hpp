// The equations of motion of any scene with its parameters as variables: what derivatives by parameters are made from.
// Mechanics are all of one kind here, H(q, p, s, t; θ): q̇ = H_p, ṗ = −H_q − p H_s, ṡ = p·H_p − H.
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

/// What the motion of a scene depends on, as numbers of the variables of one tape: the components of its state (q, p,
/// and s where the motion needs it; of a flow its variables), then the parameters in the order of the card. Shared, and
/// never changed once it is shared; stays where it is, as symbols point to its tape.
struct ParametricScene {
  ParametricScene() = default;
  ParametricScene(const ParametricScene&) = delete;
  ParametricScene& operator=(const ParametricScene&) = delete;

  std::shared_ptr<const text::Form> form;  ///< that they are written from
  tape::Tape tape;
  std::size_t components = 0, coordinates = 0;  ///< coordinates: 0 of a flow
  bool acting = false;                          ///< s is a component
  bool forced = false;                          ///< forces stand beside the mechanics
  std::vector<std::size_t> variables;           ///< of the components: their places on the card
  std::vector<double> parameters;               ///< of the card, in its order
  std::vector<Symbol> rates;                    ///< ẋ of the components
  /// Of a scene of the catalogue the same as the scheme `taylor` has it: with numbers for parameters, and with those
  /// that are varied as variables that rest.
  std::optional<tape::Program> motion, varied_motion;
  std::vector<bool> varied;     ///< of the parameters
  Symbol energy;                ///< H, where it is mechanics whose H the components say; else the constant NaN
  Symbol action_slope;          ///< H_s of mechanics
  std::vector<Symbol> momenta;  ///< p where a start may be in velocities: functions that have them in the place of p
  std::vector<double> signs;    ///< −1 of components that are the opposite of what their names say
  bool backward = false;        ///< its time is, too
  double sign_of_time() const { return backward ? -1 : 1; }
};

/// That of a scene, of whose parameters those `varied` may become variables, or why there is none. Throws
/// tape::TooManyOperations.
std::variant<std::shared_ptr<const ParametricScene>, std::string> parametric_scene(const Scene& scene,
                                                                                   const std::vector<bool>& varied);

}  // namespace least::variations
