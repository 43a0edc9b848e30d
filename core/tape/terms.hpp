// Derivatives of the terms that a tape keeps (Terms). These derivatives are again terms: the derivative of a term by
// one of its arguments is added to the adjoint of the operand that is that argument. The reverse mode so never writes
// the terms out.
// Source: Griewank & Walther, Evaluating Derivatives, 2008, 3.2 (reverse mode) and 6.1 (partially separable functions).
#pragma once

#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "core/tape/symbol.hpp"

namespace least::tape {

constexpr std::size_t nth(Index i) { return static_cast<std::size_t>(i); }

/// Returns the formula of the terms as a tape on which more can be written.
Tape tape_of(const Terms& terms);

/// Returns the derivatives of Σ adjoint[i] · (sum number i of the terms `number`) by their operands, as pairs of
/// (operand, derivative), for the operands for which `wanted` holds. The derivatives are totals of new terms, which the
/// tape keeps.
std::vector<std::pair<Index, Symbol>> slopes_of_terms(Tape& tape, Index number, std::span<const Symbol> adjoint,
                                                      const std::function<bool(Index)>& wanted);

}  // namespace least::tape
