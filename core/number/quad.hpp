// Quad: a number with 113 bits, for reference solutions. long double where the platform gives it that many, else
// Boost.Multiprecision's float128 (raw __float128 has no overloads of the elementary functions).
#pragma once

#include <cfloat>

#include "core/number/math.hpp"

#if LDBL_MANT_DIG < 113
#include <boost/multiprecision/float128.hpp>
#endif

namespace least {

#if LDBL_MANT_DIG >= 113
using Quad = long double;
#else
using Quad = boost::multiprecision::float128;
template <>
struct Precision<Quad> {
  static constexpr double epsilon = 1.92592994438723585305597794258492732e-34;
};
#endif

}  // namespace least
