// Quintic Hermite interpolation between two states, in any number type, from the equations of motion and their
// derivative along the motion. The core interpolates in double alone; laws of clocks are measured in long double.
// Source: Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, II.6.
#pragma once

#include "core/equations.hpp"

namespace least {

/// Rates holds ẏ and ÿ at x; ÿ is the derivative of the equations of motion along the motion.
template <VectorField P, class X>
struct Rates {
  X first, second;
  Rates(const P& problem, const X& x) : first(derivative(problem, x)) {
    using T = typename X::Number;
    using D = Dual<T, 1>;
    auto y = convert<D, D>(x);
    y.t.slope[0] = T(1);
    for (std::size_t i = 0; i < X::size; ++i) y[i].slope[0] = first[i];
    const auto rate = derivative(problem, y);
    for (std::size_t i = 0; i < X::size; ++i) second[i] = rate[i].slope[0];
  }
};

/// QuinticPath is the polynomial of degree 5 that has the values, first and second derivatives of `a` and `b` at both
/// ends. Error O(h⁶). It evaluates the equations of motion four times, two of them with a derivative, however many
/// times it is read.
template <VectorField P, class X>
class QuinticPath {
 public:
  QuinticPath(const P& problem, const X& a, const X& b) : a_(a), b_(b), from_(problem, a), to_(problem, b) {}

  /// The state at the time t.
  X operator()(const typename X::Time& t) const {
    using S = typename X::Time;
    const S h = b_.t - a_.t, u = (t - a_.t) / h, w = 1 - u;
    // The basis in u and in w = 1 − u: each function vanishes with its first two derivatives at the other end.
    const S w3 = w * w * w, u3 = u * u * u;
    const S a0 = w3 * (1 + 3 * u + 6 * u * u), a1 = w3 * (u + 3 * u * u) * h, a2 = w3 * u * u * 0.5 * h * h;
    const S b0 = u3 * (1 + 3 * w + 6 * w * w), b1 = -u3 * (w + 3 * w * w) * h, b2 = u3 * w * w * 0.5 * h * h;
    X x = a_;
    for (std::size_t i = 0; i < X::size; ++i)
      x[i] = a0 * a_[i] + b0 * b_[i] + (a1 * from_.first[i] + b1 * to_.first[i]) +
             (a2 * from_.second[i] + b2 * to_.second[i]);
    x.t = t;
    return x;
  }

 private:
  X a_, b_;
  Rates<P, X> from_, to_;
};

template <VectorField P, class X>
X hermite(const P& problem, const X& a, const X& b, const typename X::Time& t) {
  return QuinticPath<P, X>(problem, a, b)(t);
}

}  // namespace least
