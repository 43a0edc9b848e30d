// Problems of many degrees of freedom, of which the catalogue has none, and checks of the schemes on them.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

#include "tests/laws/clock_laws.hpp"
#include "tests/support/typed_taylor.hpp"

namespace chains {

using namespace least;

/// Toda is the Toda lattice closed to a ring: V = Σ e^(q_i − q_{i+1}). It conserves H, Σp and, being integrable, more.
template <int N>
struct Toda {
  template <class R = double>
  struct Ring {
    R strength{1};

    static constexpr int dof = N;

    template <class T, class S>
    constexpr T potential(const Vec<N, T>& q, const S&) const {
      using least::exp;
      T sum(0);
      for (std::size_t i = 0; i < N; ++i) sum = sum + exp(q[i] - q[(i + 1) % N]);
      return strength * sum;
    }
    /// Σ p and Σ p³/3 + (p_i + p_{i+1}) e^(q_i − q_{i+1})
    template <class T>
    constexpr Vec<2, T> invariants(const Vec<N, T>& q, const Vec<N, T>& p, double) const {
      using least::exp;
      Vec<2, T> sum{};
      for (std::size_t i = 0; i < N; ++i) {
        const std::size_t next = (i + 1) % N;
        sum[0] = sum[0] + p[i];
        sum[1] = sum[1] + p[i] * p[i] * p[i] / 3 + strength * ((p[i] + p[next]) * exp(q[i] - q[next]));
      }
      return sum;
    }
  };
  /// With friction: H = K + V + αs.
  template <class R = double>
  struct Damped : Ring<R> {
    R alpha{0.2};
    constexpr R damping() const { return alpha; }
  };
  /// H = K + V + γs²/2 − R
  template <class R = double>
  struct Quadratic : Ring<R> {
    R gamma{0.1}, radius{0.3};
    constexpr R action_curvature() const { return gamma; }
    constexpr R offset() const { return radius; }
  };
};

/// Lorenz96 is ẏ_i = (y_{i+1} − y_{i−2}) y_{i−1} − y_i + F (Lorenz 1996), a flow that no scheme splits.
template <int N>
struct Lorenz96 {
  template <class R = double>
  struct Flow {
    R forcing{8};

    static constexpr int dim = N;

    template <class T, class S>
    constexpr Vec<N, T> field(const Vec<N, T>& y, const S&) const {
      Vec<N, T> rate{};
      for (std::size_t i = 0; i < N; ++i)
        rate[i] = (y[(i + 1) % N] - y[(i + N - 2) % N]) * y[(i + N - 1) % N] - y[i] + forcing;
      return rate;
    }
  };
};

/// start() returns a state without symmetry.
template <class X>
X start() {
  X x;
  for (std::size_t i = 0; i < X::size; ++i) x[i] = 0.6 * std::sin(1.0 + 2.3 * double(i * i));
  return x;
}

template <class P, class X>
X truth(const P& problem, const X& from, double t) {
  Extrapolation<P, typename X::template in<Quad, Quad>> orbit(problem, convert<Quad, Quad>(from), 1e-24);
  EXPECT_TRUE(orbit.advance(Quad(t), [] { return true; }));
  return convert<double, double>(orbit.state());
}

using Names = std::set<std::string>;

/// fixed_steps_have_their_order() checks that every fixed-step scheme that compiles for P has its order, by the errors
/// of 20 and 40 steps over `span`, and keeps the value of `kept(x)`. It returns the ids of these schemes.
template <template <class> class P, class Kept>
Names fixed_steps_have_their_order(double span, Kept&& kept) {
  const P<double> problem;
  const auto from = start<FullStateOf<P<double>>>(), end = truth(problem, from, span);
  Names names;
  laws::for_each_scheme<P>([&](const auto& scheme) {
    const std::string what = laws::label(scheme);
    names.insert(std::string(scheme.card().id));
    const auto error = [&](int n) {
      auto x = from;
      auto stepper = scheme.bind(problem, x);
      for (int k = 0; k < n; ++k) {
        EXPECT_EQ(stepper.step(x, span / n), StepStatus::ok) << what;
        x.t = (k + 1) * span / n;
      }
      EXPECT_NEAR(kept(x), kept(from), 1e-13) << what;
      return laws::distance(x, end);
    };
    const double coarse = error(20), fine = error(40);
    EXPECT_LT(coarse, 0.1) << what;
    if (fine > 1e-11) {
      EXPECT_NEAR(std::log2(coarse / fine), laws::order(scheme), 0.35) << what << " to " << fine;
    } else {
      EXPECT_GE(laws::order(scheme), 4) << what << " is better than it says: " << fine;
    }
  });
  return names;
}

/// tolerances_are_met() checks that the errors of the schemes with a tolerance (Odeint's, and `taylor`) lie between
/// 1e-6 and 100 tolerances. It returns the ids of these schemes.
template <template <class> class P>
Names tolerances_are_met(double span) {
  const P<double> problem;
  const auto from = start<FullStateOf<P<double>>>(), end = truth(problem, from, span);
  Names names;
  const auto one = [&]<class Scheme>(Scheme scheme) {
    if constexpr (requires { scheme.tolerance; } && SelfTimedSchemeFor<Scheme, P<double>>) {
      names.insert(std::string(scheme.card().id));
      for (const double tolerance : {1e-5, 1e-8, 1e-11}) {
        scheme.tolerance = tolerance;
        auto x = from;
        auto stepper = scheme.bind(problem, x);
        while (x.t < end.t) {
          const auto before = stepper;
          const auto last = x;
          ASSERT_EQ(stepper.step(x), StepStatus::ok);
          if (!(x.t > end.t)) continue;
          stepper = before;
          x = last;
          ASSERT_EQ(stepper.reach(x, end.t), StepStatus::ok);
        }
        const double error = laws::distance(x, end) / laws::size(end);
        EXPECT_LT(error, 100 * tolerance) << scheme.card().id;
        EXPECT_GT(error, 1e-6 * tolerance) << scheme.card().id;
      }
    }
  };
  [&]<class... Scheme>(std::tuple<Scheme...>*) { (one(Scheme{}), ...); }(static_cast<SchemeList*>(nullptr));
  one(TypedTaylor{});
  return names;
}

/// clocks_have_their_order() checks the schemes that choose their own steps, the hybrid on either side of its switch:
/// with steps 8 times as short the error falls by about 8^order. It returns the ids of these schemes.
template <template <class> class P>
Names clocks_have_their_order(double span) {
  const P<double> problem;
  const auto from = start<StateOf<P<double>>>(), end = truth(problem, from, span);
  Names names;
  laws::for_each_clock<P>([&](const auto& scheme, int order) {
    names.insert(std::string(scheme.card().id));
    const auto error = [&](double h) {
      auto x = from;
      EXPECT_EQ(laws::arrive(laws::resized(scheme, problem, from, h), problem, x, end.t), StepStatus::ok)
          << laws::label(scheme);
      return laws::distance(x, end);
    };
    const double coarse = error(span / 12), fine = error(span / 96);
    EXPECT_LT(coarse, 0.1) << laws::label(scheme);
    EXPECT_LT(fine, 4 * std::pow(8.0, -order) * coarse + 1e-12) << laws::label(scheme) << order << " from " << coarse;
  });
  return names;
}

}  // namespace chains
