// Equations ẋ = X(x, t) as a sum of lifts. With momenta beside x they are those of H = p·X, and each part of it,
// Σ p_i X_i over some of the variables, moves these alone while all others rest: variables of which none reads another
// one's rate go together, so that q̇ = v, v̇ = f(q) has two parts.
// Source: Kevrekidis, arXiv 2605.09103 (2026); McLachlan & Quispel, Acta Numerica 11, 341 (2002), 3.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/tape/formula.hpp"
#include "core/text/form.hpp"
#include "core/text/lift.hpp"

namespace least::text {

struct FlowParts {
  /// Variables of the largest scene.
  static constexpr std::size_t most_variables = 256;

  struct Part {
    std::vector<std::size_t> of;  ///< the variables that it moves
    bool affine = true;           ///< each rate is linear in its own variable: the motion is exact
    tape::Formula rates;          ///< X_i of each of them, then ∂X_i/∂x_i of each
  };
  std::size_t variables = 0;
  bool autonomous = true;
  std::vector<Part> parts;
  /// Of p·X as a whole; null where there are too many variables to solve for all at once.
  std::shared_ptr<const Lift> lift;

  bool linear() const { return lift && lift->linear; }
};

/// Of equations with these parameters, or why they have none, in words. `moved`: a parameter that stays a variable, and
/// stands after the others.
std::variant<FlowParts, std::string> flow_parts(const Form& form, std::span<const double> parameters,
                                                std::optional<std::size_t> moved = {});

}  // namespace least::text
