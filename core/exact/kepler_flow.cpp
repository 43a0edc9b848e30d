#include "core/exact/kepler_flow.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace least::two_body {
namespace {

template <class T>
struct Universal {
  T g0, g1, g2, g3;
};

/// Σ (−1)^j x^j/(2j + k)! to round-off for |x| < 1, in two halves at once.
template <int k, class T>
T stumpff(const T& x) {
  static constexpr auto c = [] {
    std::array<double, 9> all{};
    double factorial = 1;
    for (int i = 2; i <= k; ++i) factorial *= i;
    for (int j = 0; j < 9; ++j) {
      all[static_cast<std::size_t>(j)] = (j % 2 == 0 ? 1 : -1) / factorial;
      factorial *= (2 * j + k + 1) * (2 * j + k + 2);
    }
    return all;
  }();
  const T y = x * x, z = y * y;
  return (c[0] + c[1] * x + (c[2] + c[3] * x) * y) + z * ((c[4] + c[5] * x + (c[6] + c[7] * x) * y) + z * c[8]);
}

/// G₀ … G₃ by series at s/2ⁿ, followed by n doublings. No root of β is taken: its rounding error would be the same at
/// every step, and the energy would drift.
template <class T>
Universal<T> universal(const T& beta, const T& s) {
  using least::abs;
  constexpr int most_halvings = 16;  // beyond, what grows as an exponential overflows
  T part = s, x = beta * s * s;
  int halvings = 0;
  for (; !(abs(x) < T(1)); ++halvings) {
    if (halvings == most_halvings) {
      const T none(std::numeric_limits<double>::quiet_NaN());
      return {none, none, none, none};
    }
    part = 0.5 * part;
    x = 0.25 * x;
  }
  const T square = part * part;
  T g2 = square * stumpff<2>(x), g3 = square * part * stumpff<3>(x), g1 = part - beta * g3, g0 = 1 - beta * g2;
  for (; halvings > 0; --halvings) {
    g3 = 2 * (g3 + g1 * g2);
    g2 = 2 * g1 * g1;
    g1 = 2 * g0 * g1;
    g0 = 1 - beta * g2;
  }
  return {g0, g1, g2, g3};
}

/// Solver finds the s at which the time along the orbit is dt. The time grows with s, at the rate r > 0, so a bracket
/// converges however bad the guesses are.
class Solver {
 public:
  /// over: 1/r₀
  Solver(double r0, double over, double eta, double beta, double mu)
      : r0_(r0), over_(over), eta_(eta), beta_(beta), mu_(mu), zeta_(mu - beta * r0) {}

  /// Returns G₀ … G₃ and sets s, right to the last digit, and r there; not finite where there is no solution.
  Universal<double> at(double dt, double& s, double& r) const {
    s = guess(dt);
    const Universal<double> g = universal(beta_, s);
    if (const auto ended = end(g, dt, s, r)) return *ended;
    return search(dt, s, r);
  }

 private:
  double late(const Universal<double>& g, double dt) const { return (r0_ * g.g1 + eta_ * g.g2 + mu_ * g.g3) - dt; }
  double distance(const Universal<double>& g) const { return r0_ * g.g0 + eta_ * g.g1 + mu_ * g.g2; }
  /// dr/ds.
  double slope(const Universal<double>& g) const { return eta_ * g.g0 + zeta_ * g.g1; }

  /// If s is almost right, corrects s, G and r by the first terms of their series in the rest; otherwise returns
  /// nothing.
  std::optional<Universal<double>> end(const Universal<double>& g, double dt, double& s, double& r) const {
    constexpr double near = 1e-6;
    const double over = 1 / distance(g), first = -late(g, dt) * over, bend = first * slope(g) * over;
    if (!(std::abs(first) <= near * std::abs(s) && std::abs(bend) <= near)) return std::nullopt;
    const double d = first * (1 - 0.5 * bend), half = 0.5 * d * d;
    const Universal<double> there{g.g0 - beta_ * (d * g.g1 + half * g.g0), g.g1 + d * g.g0 - half * beta_ * g.g1,
                                  g.g2 + d * g.g1 + half * g.g0, g.g3 + d * g.g2 + half * g.g1};
    s += d;
    r = distance(there);
    return there;
  }

  /// Searches by Laguerre's rule, and by halving where that would leave the bracket.
  [[gnu::noinline]] Universal<double> search(double dt, double& s, double& r) const {
    constexpr int most_rounds = 2000, rounds_by_rule = 50;
    const double sign = dt < 0 ? -1 : 1, infinite = std::numeric_limits<double>::infinity();
    double low = 0, high = beta_ > 0 ? 2 * std::numbers::pi / std::sqrt(beta_) : infinite;
    if (!(std::abs(s) < high)) s = sign * 0.5 * high;
    for (int round = 0;; ++round) {
      const Universal<double> g = universal(beta_, s);
      if (const auto ended = end(g, dt, s, r)) return *ended;
      r = distance(g);
      const double wrong = late(g, dt), size = std::abs(s);
      if (round == most_rounds || !(high - low > 4 * std::numeric_limits<double>::epsilon() * size)) return g;
      (sign * wrong < 0 ? low : high) = size;  // a time that is not a number is too late
      s -= 5 * wrong / (r + std::sqrt(std::abs(16 * r * r - 20 * wrong * slope(g))));
      if (!(s * sign > low && s * sign < high) || round > rounds_by_rule)
        s = sign * (high < infinite ? 0.5 * (low + high) : 2 * low);
    }
  }

  /// Returns a first s: by the series of the time in s, inverted, where its terms decrease; else by the mean motion of
  /// an ellipse, or by the dominant term of the time.
  double guess(double dt) const {
    constexpr double trusted = 0.5;
    const double a = dt * over_, first = 0.5 * eta_ * over_ * a, square = a * a,
                 second = zeta_ * over_ * square * (1.0 / 6);
    if (std::abs(first) < trusted && std::abs(second) < trusted) {
      const double third = beta_ * square * first * (1.0 / 12);
      return a * (1 - first + (2 * first * first - second) + (5 * first * (second - first * first) + third));
    }
    if (beta_ > 0) return dt * beta_ / mu_;
    return std::copysign(std::fmin(std::abs(a), std::cbrt(6 * std::abs(dt) / std::abs(mu_))), dt);
  }

  double r0_, over_, eta_, beta_, mu_, zeta_;
};

/// Returns dt without the whole periods of an ellipse.
double within_half_a_period(double beta, double mu, double dt) {
  constexpr double pi = std::numbers::pi;
  if (!(beta > 0) || dt * dt * (beta * beta * beta) <= pi * pi * mu * mu) return dt;
  const double period = 2 * pi * mu / (beta * std::sqrt(beta));
  return dt - period * std::round(dt / period);
}

}  // namespace

KeplerChange<double> kepler_change(double qq, double qv, double vv, double mu, double dt) noexcept {
  const double r0 = std::sqrt(qq), over = 1 / r0, beta = 2 * mu * over - vv;
  dt = within_half_a_period(beta, mu, dt);
  double s, r;
  const auto g = Solver(r0, over, qv, beta, mu).at(dt, s, r);
  const double there = 1 / r, pull = -mu * over;
  return {pull * g.g2, dt - mu * g.g3, pull * g.g1 * there, -mu * g.g2 * there};
}

KeplerChange<Dual<double, 1>> kepler_change(const Dual<double, 1>& qq, const Dual<double, 1>& qv,
                                            const Dual<double, 1>& vv, double mu, double dt) noexcept {
  using T = Dual<double, 1>;
  const T r0 = sqrt(qq), beta = 2 * mu / r0 - vv;
  T left = dt;
  if (const double rest = within_half_a_period(beta.value, mu, dt); rest != dt) {
    const T period = 2 * std::numbers::pi * mu / (beta * sqrt(beta));  // which changes with the start
    left = dt - period * std::round(dt / period.value);
    left.value = rest;
  }
  double s, r_there;
  Solver(r0.value, 1 / r0.value, qv.value, beta.value, mu).at(left.value, s, r_there);
  // One step of Newton's from there has the right derivatives.
  const auto r_at = [&](const Universal<T>& g) { return r0 * g.g0 + qv * g.g1 + mu * g.g2; };
  Universal<T> g = universal(beta, T(s));
  g = universal(beta, T(T(s) + (left - (r0 * g.g1 + qv * g.g2 + mu * g.g3)) / r_at(g)));
  const T r = r_at(g), pull = -mu / r0;
  return {pull * g.g2, left - mu * g.g3, pull * g.g1 / r, -mu * g.g2 / r};
}

}  // namespace least::two_body
