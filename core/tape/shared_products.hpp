// Products that more than one sum has.
#pragma once

#include "core/tape/program.hpp"

namespace least::tape {

/// Makes each of them a value, once: what sums to and fro of bodies have in common is then computed once in an order,
/// and the sums are of values. Other roundings, the same program else.
void share_products(Program& program);

}  // namespace least::tape
