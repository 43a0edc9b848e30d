// What is made of the terms that a tape keeps: their derivatives are terms again, closed under the reverse mode, as the
// slope by an argument of a term is added to what that argument is of all terms.
// Source: Griewank & Walther, Evaluating Derivatives, 2008, 3.2 (reverse mode) and 6.1 (partially separable functions).
#pragma once

#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "core/tape/symbol.hpp"

namespace least::tape {

constexpr std::size_t nth(Index i) { return static_cast<std::size_t>(i); }

/// The formula of terms, on which more can be written.
Tape tape_of(const Terms& terms);

/// The slopes of Σ adjoint[i] · (sum number i of terms) by their operands for which `wanted` holds: each operand
/// with what derived terms, which the tape keeps from now on, add up to.
std::vector<std::pair<Index, Symbol>> slopes_of_terms(Tape& tape, Index number, std::span<const Symbol> adjoint,
                                                      const std::function<bool(Index)>& wanted);

}  // namespace least::tape
