#include "core/run/diagnostics/lyapunov.hpp"

namespace least {

std::string_view verdict_of(double growth, double megno) {
  constexpr double little = 0.5, linear = 1.5, exponential = 3, far = 4;  // far: a growth that no transient makes
  if (megno < -little) return "contracts: neighbours come together, as on the way to an attracting cycle or to rest";
  if (megno <= little) return "steady: neighbours stay together, as on an attracting cycle or in a linear oscillation";
  if (megno >= linear && megno <= exponential) return "regular: neighbours part in proportion to time";
  if (megno > exponential && growth > far) return "unstable: neighbours part exponentially, as in chaos";
  return "undecided: a longer run tells";
}

}  // namespace least
