// A scene as text as bodies that revolve: H = Σ p²/2m + V whose V has a term −k/r for each of them, about one body that
// is heavier than all or about a fixed point, and what else there is beside. It is found from V alone, however it is
// written: terms c (Σ of squares of differences)^(−1/2), in the plane or in space. Which coordinates are those of one
// body follows from the terms that they stand in.
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

struct Planetary {
  static constexpr std::size_t no_axis = std::numeric_limits<std::size_t>::max();

  /// The first is the centre, where that is a body.
  struct Body {
    std::array<std::size_t, 3> coordinates{no_axis, no_axis, no_axis};
    double mass = 1;
    double strength = 0;  ///< k of −k/r to the centre; of the centre itself 0
  };
  std::vector<Body> bodies;
  bool about_body = false;
  std::array<double, 3> centre{};  ///< where it is no body

  /// −k/r between two that revolve.
  struct Pair {
    std::size_t a, b;
    double strength;
  };
  std::vector<Pair> pairs;
  tape::Formula rest;  ///< the slopes of what else V has, by every coordinate of the scene; no outputs: nothing
};

/// Why a scene is none, in words.
struct NotPlanetary {
  std::string why;
};

/// Of a form with these parameters; `names`: of its coordinates.
std::variant<Planetary, NotPlanetary> planetary(const Form& form, std::span<const double> parameters,
                                                std::span<const std::string> names);

}  // namespace least::text
