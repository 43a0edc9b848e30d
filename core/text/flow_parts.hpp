// Equations ẋ = X(x, t) split into explicitly solvable parts. With momenta p added, the equations are those of H = p·X,
// and each part Σ p_i X_i over some of the variables moves only these while all others rest. Variables whose rates do
// not read one another are put into one part: q̇ = v, v̇ = f(q) has two parts.
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

/// FlowParts are the parts of a flow with numbers in the place of its parameters.
struct FlowParts {
  /// Largest number of variables for which a flow is split.
  static constexpr std::size_t most_variables = 256;

  /// Part moves some variables while all others rest.
  struct Part {
    std::vector<std::size_t> of;  ///< numbers of the variables that the part moves
    bool affine = true;           ///< each rate is affine in its own variable, so that the part's motion is exact
    tape::Formula rates;          ///< of the variables in `of`: X_i, then ∂X_i/∂x_i
  };
  std::size_t variables = 0;
  bool autonomous = true;
  std::vector<Part> parts;
  /// The lift of p·X as a whole; null where there are too many variables to solve for them at once.
  std::shared_ptr<const Lift> lift;

  bool linear() const { return lift && lift->linear; }
};

/// flow_parts returns the parts of equations with these parameters, or a phrase that says why there are none. `moved`
/// is a parameter that stays a variable of the formulas, behind the others.
std::variant<FlowParts, std::string> flow_parts(const Form& form, std::span<const double> parameters,
                                                std::optional<std::size_t> moved = {});

}  // namespace least::text
