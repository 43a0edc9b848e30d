// Operation is one step of an evaluation. A tape is translated to a list of them (core/tape/translation.hpp), each with
// a value of its own.
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
  add_up,  ///< computes all sums of the terms number `value`
  total    ///< sum number `value` of those that step a computes
};

/// a, b and c are the numbers of earlier operations; for `variable`, a is the number of the variable.
struct Operation {
  Code code;
  Index a = none, b = none, c = none;
  double value = 0;
};

}  // namespace least::tape
