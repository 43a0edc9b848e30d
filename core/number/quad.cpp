#include "core/number/quad.hpp"

#if LDBL_MANT_DIG < 113
#include <quadmath.h>

#include <string>

namespace least {

Quad::Quad(std::string_view text) : bits_(strtoflt128(std::string(text).c_str(), nullptr)) {}

Quad sqrt(const Quad& x) { return Quad::from(sqrtq(x.bits())); }
Quad exp(const Quad& x) { return Quad::from(expq(x.bits())); }
Quad log(const Quad& x) { return Quad::from(logq(x.bits())); }
Quad sin(const Quad& x) { return Quad::from(sinq(x.bits())); }
Quad cos(const Quad& x) { return Quad::from(cosq(x.bits())); }
Quad tan(const Quad& x) { return Quad::from(tanq(x.bits())); }
Quad asin(const Quad& x) { return Quad::from(asinq(x.bits())); }
Quad acos(const Quad& x) { return Quad::from(acosq(x.bits())); }
Quad atan(const Quad& x) { return Quad::from(atanq(x.bits())); }
Quad sinh(const Quad& x) { return Quad::from(sinhq(x.bits())); }
Quad cosh(const Quad& x) { return Quad::from(coshq(x.bits())); }
Quad tanh(const Quad& x) { return Quad::from(tanhq(x.bits())); }
Quad floor(const Quad& x) { return Quad::from(floorq(x.bits())); }
Quad atan2(const Quad& y, const Quad& x) { return Quad::from(atan2q(y.bits(), x.bits())); }
Quad pow(const Quad& x, const Quad& y) { return Quad::from(powq(x.bits(), y.bits())); }

}  // namespace least
#endif
