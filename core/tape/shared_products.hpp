// Products that several sums of a program contain.
#pragma once

#include "core/tape/program.hpp"

namespace least::tape {

/// Replaces a product that several sums of the motion contain by one value, which is computed once in each order: pairs
/// of bodies have the same product in the forces on both. Rounding errors change, because a sum then adds a rounded
/// product.
void share_products(Program& program);

}  // namespace least::tape
