// Orbiting bodies in a scene given as text: H = Σ p²/2m + V, where V has a term −k/r for each body, about a body that
// is heavier than all others or about a fixed point, and further terms. This is recognised in V alone, however it is
// written, by terms c (Σ of squared differences)^(−1/2) in the plane or in space. Which coordinates belong to one body
// follows from the terms that contain them.
#pragma once

#include <array>
#include <limits>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/tape/formula.hpp"
#include "core/text/form.hpp"

namespace least::text {

/// Planetary lists the bodies of a scene and the rest of its potential.
struct Planetary {
  static constexpr std::size_t no_axis = std::numeric_limits<std::size_t>::max();

  /// One of the bodies. The first is the centre, where the centre is a body.
  struct Body {
    std::array<std::size_t, 3> coordinates{no_axis, no_axis, no_axis};
    double mass = 1;
    double strength = 0;  ///< k of the term −k/r to the centre; 0 for the centre itself
  };
  std::vector<Body> bodies;
  bool about_body = false;
  std::array<double, 3> centre{};  ///< the fixed centre, where it is no body

  /// Pair is a term −strength/r between two orbiting bodies a and b.
  struct Pair {
    std::size_t a, b;
    double strength;
  };
  std::vector<Pair> pairs;
  /// ∂/∂q_i of the rest of V, for every coordinate of the scene; without outputs where there is no rest
  tape::Formula rest;
};

/// NotPlanetary says in words why a scene has no such form.
struct NotPlanetary {
  std::string why;
};

/// planetary returns the bodies of a form with these parameters; `names` are those of its coordinates, for the message.
std::variant<Planetary, NotPlanetary> planetary(const Form& form, std::span<const double> parameters,
                                                std::span<const std::string> names);

}  // namespace least::text
