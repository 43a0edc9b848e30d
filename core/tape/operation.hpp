// What a tape is lowered to before it is evaluated: one operation after the other, each with a value of its own.
#pragma once

#include <cstdint>

#include "core/tape/tape.hpp"

namespace least::tape {

enum class Code : std::uint8_t {
  constant,
  variable,
  time,
  add,
  subtract,
  multiply,
  divide,
  add_constant,   ///< a + value
  from_constant,  ///< value − a
  scale,          ///< value a
  over,           ///< value/a
  power,          ///< a^value
  sqrt,
  exp,
  log,
  sin,
  cos,
  tan,
  sinh,
  cosh,
  tanh,
  atan,
  asin,
  acos,
  select,  ///< b where a < 0, else c
  add_up,  ///< all sums of the terms number `value`
  total    ///< sum number `value` of those that a adds up
};

/// a, b and c are earlier operations by their number; of `variable`, a is which one.
struct Operation {
  Code code;
  Index a = none, b = none, c = none;
  double value = 0;
};

}  // namespace least::tape
