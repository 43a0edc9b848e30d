// Between two states: quintic Hermite interpolation, from the equations of motion and their derivative along the
// motion. Source: Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, II.6.
#pragma once

#include "core/problem.hpp"

namespace least {

/// ẏ and ÿ at x: the second by differentiating the equations of motion along themselves.
template <VectorField P, class X>
struct Motion {
  X first, second;
  Motion(const P& problem, const X& x) : first(derivative(problem, x)) {
    using T = typename X::Number;
    using D = Dual<T, 1>;
    auto y = convert<D, D>(x);
    y.t.slope[0] = T(1);
    for (std::size_t i = 0; i < X::size; ++i) y[i].slope[0] = first[i];
    const auto rate = derivative(problem, y);
    for (std::size_t i = 0; i < X::size; ++i) second[i] = rate[i].slope[0];
  }
};

/// The state at the time t between `a` and `b`: the polynomial of degree 5 that meets values, first and second
/// derivatives at both ends. Error O(h⁶). Four evaluations of the equations of motion, two of them with a derivative.
template <VectorField P, class X>
X hermite(const P& problem, const X& a, const X& b, const typename X::Time& t) {
  using S = typename X::Time;
  const Motion<P, X> from(problem, a), to(problem, b);
  const S h = b.t - a.t, u = (t - a.t) / h, w = 1 - u;
  // The basis in u and in 1 − u: each vanishes with its derivatives at the other end.
  const S w3 = w * w * w, u3 = u * u * u;
  const S a0 = w3 * (1 + 3 * u + 6 * u * u), a1 = w3 * (u + 3 * u * u) * h, a2 = w3 * u * u * 0.5 * h * h;
  const S b0 = u3 * (1 + 3 * w + 6 * w * w), b1 = -u3 * (w + 3 * w * w) * h, b2 = u3 * w * w * 0.5 * h * h;
  X x = a;
  for (std::size_t i = 0; i < X::size; ++i)
    x[i] = a0 * a[i] + b0 * b[i] + (a1 * from.first[i] + b1 * to.first[i]) + (a2 * from.second[i] + b2 * to.second[i]);
  x.t = t;
  return x;
}

}  // namespace least
