#include "core/run/root.hpp"

#include <boost/math/tools/minima.hpp>
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

std::optional<double> dip(const std::function<double(double)>& f, double a, double b) {
  const auto at = [&](double part) { return a + part * (b - a); };  // in parts: Boost's bounds are absolute, too
  const auto value = [&](double part) { return f(at(part)); };
  constexpr double near = 0x1p-16;
  if (!(value(near) < f(a) && value(1 - near) < f(b))) return std::nullopt;
  constexpr int bits = 26;  // half of the digits: all that a minimum has
  std::uintmax_t most = 50;
  const auto [place, least] = boost::math::tools::brent_find_minima(value, 0.0, 1.0, bits, most);
  return least < 0 ? std::optional(at(place)) : std::nullopt;
}

}  // namespace least
