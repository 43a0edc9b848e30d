#include "core/run/root.hpp"

#include <boost/math/tools/toms748_solve.hpp>
#include <cstdint>
#include <numeric>

namespace least {

double root(const std::function<double(double)>& f, double a, double b) {
  const double fa = f(a), fb = f(b);
  if (fa == 0) return a;
  if (fb == 0 || !(fa * fb < 0)) return b;
  std::uintmax_t most = 100;
  const auto [low, high] =
      boost::math::tools::toms748_solve(f, a, b, fa, fb, boost::math::tools::eps_tolerance<double>(50), most);
  return std::midpoint(low, high);
}

}  // namespace least
