// Square matrices of what a text says, row by row: second derivatives by velocities or momenta.
#pragma once

#include <optional>
#include <vector>

#include "core/tape/symbol.hpp"

namespace least::text {

using SymbolMatrix = std::vector<std::vector<Symbol>>;

/// The number 0, whatever the values of variables.
bool is_nothing(const Symbol& x);

/// Numbers, and not all of one sign by any change of coordinates: K of both signs is as regular as any, but nothing
/// that schemes take for granted of a natural form. All negative, it is one that was typed with a wrong sign; what
/// depends on parameters or the place is told where these are known.
bool is_indefinite(const SymbolMatrix& second);

/// By elimination; rows change places where a pivot is zero whatever the values. Nothing where there is no other. Takes
/// the room of two of them.
std::optional<SymbolMatrix> inverse_of(SymbolMatrix a);

}  // namespace least::text
