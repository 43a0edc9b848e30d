// Laws of a description: that it is generic in the number, and that what it states twice agrees.
#pragma once

#include <gtest/gtest.h>

#include <bit>

#include "tests/laws/scene.hpp"
#include "tests/support/lanes.hpp"
#include "tests/support/symbol.hpp"

namespace laws {

using toy::Lanes;

/// Hamilton's equations and the Hamiltonian written on a tape at compile time: the lines of q̇, ṗ and H.
template <class P>
struct Recorded {
  toy::Tape tape;
  Vec<2 * P::dof, int> lines{};
  int energy = 0;
};
template <class P>
constexpr Recorded<P> record_equations() {
  toy::Tape tape;
  StateOf<P, toy::Symbol> x;
  for (int i = 0; i < P::dof; ++i) x.q[std::size_t(i)] = toy::Symbol(tape, i);
  for (int i = 0; i < P::dof; ++i) x.p[std::size_t(i)] = toy::Symbol(tape, P::dof + i);
  const auto d = derivative(P{}, x);
  Recorded<P> r;
  for (std::size_t i = 0; i < P::dof; ++i) {
    r.lines[i] = d.q[i].on(tape);
    r.lines[P::dof + i] = d.p[i].on(tape);
  }
  r.energy = hamiltonian(P{}, x.q, x.p, 0.0).on(tape);
  r.tape = tape;
  return r;
}

template <template <class> class P>
void recorded() {
  static constexpr auto record = record_equations<P<double>>();
  static_assert(record.tape.size > 2 * P<double>::dof, "the mechanics can be recorded at compile time");
  for (const auto& x : states<P>()) {
    std::array<double, 2 * P<double>::dof> y;
    std::copy(x.q.begin(), x.q.end(), y.begin());
    std::copy(x.p.begin(), x.p.end(), y.begin() + P<double>::dof);
    const auto d = derivative(P<double>{}, x);
    for (std::size_t i = 0; i < P<double>::dof; ++i) {
      EXPECT_DOUBLE_EQ(record.tape.replay(record.lines[i], y), d.q[i]);
      EXPECT_NEAR(record.tape.replay(record.lines[P<double>::dof + i], y), d.p[i], 1e-14 * (1 + std::abs(d.p[i])));
    }
    const double h = hamiltonian(P<double>{}, x.q, x.p, 0.0);
    EXPECT_NEAR(record.tape.replay(record.energy, y), h, 1e-14 * (1 + std::abs(h)));
  }
}

/// Parameters may be dual numbers: the sensitivity of a step to each of them, against a difference quotient.
template <template <class> class P>
void parameters_can_be_dual() {
  using D = Dual<double, 1>;
  const double h = coarse_step<P>(), small = 1e-5;
  const StateOf<P<double>> start = states<P>()[0];
  const auto step = [&](const auto& scheme, const auto& problem, auto x) {
    auto stepper = scheme.bind(problem, x);
    EXPECT_EQ(stepper.step(x, h), Status::ok);
    return x;
  };
  // An aggregate of parameters and nothing else (rule 1) is an array of them.
  constexpr std::size_t count = std::tuple_size_v<std::remove_cvref_t<decltype(About<P>::fields)>>;
  using Narrow = std::array<double, count>;
  using Wide = std::array<D, count>;
  static_assert(sizeof(P<double>) == sizeof(Narrow) && sizeof(P<D>) == sizeof(Wide));
  for_each_scheme<P>([&](const auto& scheme) {
    for (std::size_t k = 0; k < count; ++k) {
      auto values = std::bit_cast<Narrow>(P<double>{});
      const double value = values[k];
      values[k] = value + small;
      const auto up = step(scheme, std::bit_cast<P<double>>(values), start);
      values[k] = value - small;
      const auto down = step(scheme, std::bit_cast<P<double>>(values), start);
      auto wide = std::bit_cast<Wide>(P<D>{});
      wide[k].slope[0] = 1;
      StateOf<P<double>, D> x;
      for (std::size_t i = 0; i < P<double>::dof; ++i) {
        x.q[i] = start.q[i];
        x.p[i] = start.p[i];
      }
      const auto y = step(scheme, std::bit_cast<P<D>>(wide), x);
      for (std::size_t i = 0; i < P<double>::dof; ++i) {
        EXPECT_NEAR(y.q[i].slope[0], (up.q[i] - down.q[i]) / (2 * small), 1e-7 * size(start)) << label(scheme);
        EXPECT_NEAR(y.p[i].slope[0], (up.p[i] - down.p[i]) / (2 * small), 1e-7 * size(start)) << label(scheme);
      }
    }
  });
}

template <template <class> class P>
StateOf<P<double>, Lanes> in_lanes() {
  StateOf<P<double>, Lanes> x;
  for (std::size_t lane = 0; lane < toy::width; ++lane)
    for (std::size_t i = 0; i < P<double>::dof; ++i) {
      x.q[i].v[lane] = states<P>()[lane].q[i];
      x.p[i].v[lane] = states<P>()[lane].p[i];
    }
  return x;
}
template <class X, class Y>
void expect_same_bits(const X& lanes, const Y& scalar, std::size_t lane, const std::string& what) {
  for (std::size_t i = 0; i < scalar.q.size(); ++i) {
    EXPECT_EQ(lanes.q[i].v[lane], scalar.q[i]) << what;
    EXPECT_EQ(lanes.p[i].v[lane], scalar.p[i]) << what;
  }
}

template <template <class> class P>
void lanes_through_problem() {
  const P<double> problem;
  const auto x = in_lanes<P>();
  const auto d = derivative(problem, x);
  const auto h = hamiltonian(problem, x.q, x.p, 0.0);
  for (std::size_t lane = 0; lane < toy::width; ++lane) {
    const auto& y = states<P>()[lane];
    expect_same_bits(d, derivative(problem, y), lane, "derivative");
    EXPECT_EQ(h.v[lane], hamiltonian(problem, y.q, y.p, 0.0));
    if constexpr (HasFrequency<P<double>>) {
      EXPECT_EQ(problem.frequency_squared(x.q).v[lane], problem.frequency_squared(y.q));
    }
    if constexpr (HasInvariants<P<double>>) {
      const auto wide = problem.invariants(x.q, x.p, 0.0);
      const auto narrow = problem.invariants(y.q, y.p, 0.0);
      for (std::size_t i = 0; i < wide.size(); ++i) EXPECT_EQ(wide[i].v[lane], narrow[i]);
    }
  }
}

template <template <class> class P>
void lanes_through_schemes() {
  const P<double> problem;
  const double h = About<P>::card().suggested.at(0).second;
  for_each_scheme<P>([&](const auto& scheme) {
    auto x = in_lanes<P>();
    auto wide = scheme.bind(problem, x);
    for (int k = 0; k < 3; ++k) ASSERT_EQ(wide.step(x, h), Status::ok) << label(scheme);
    for (std::size_t lane = 0; lane < toy::width; ++lane) {
      auto y = states<P>()[lane];
      y.t = 0;
      auto narrow = scheme.bind(problem, y);
      for (int k = 0; k < 3; ++k) ASSERT_EQ(narrow.step(y, h), Status::ok);
      expect_same_bits(x, y, lane, label(scheme));
    }
  });
}

/// The same source in quad precision gives the same step to double's round-off.
template <template <class> class P>
void quad_through_schemes() {
  const P<double> problem;
  const double h = About<P>::card().suggested.at(0).second;
  for_each_scheme<P>([&](const auto& scheme) {
    auto x = convert<Quad, Quad>(states<P>()[1]);
    auto y = states<P>()[1];
    auto wide = scheme.bind(problem, x);
    auto narrow = scheme.bind(problem, y);
    ASSERT_EQ(wide.step(x, Quad(h)), Status::ok) << label(scheme);
    ASSERT_EQ(narrow.step(y, h), Status::ok);
    EXPECT_LT(distance(convert<double, double>(x), y), 2e-13 * size(y)) << label(scheme);
  });
}

template <template <class> class P>
void force_is_minus_gradient() {
  const P<double> problem;
  for (const auto& x : states<P>()) {
    const auto by_hand = gradient(problem, x.q, 0.0);
    const auto derived = problem.potential(seed<P<double>::dof, double>(x.q), 0.0).slope;
    for (std::size_t i = 0; i < by_hand.size(); ++i)
      EXPECT_NEAR(by_hand[i], derived[i], 1e-13 * (1 + std::abs(derived[i])));
    // The potential itself against a difference quotient, so that the derivative of a wrong branch is not taken for
    // truth.
    for (std::size_t i = 0; i < by_hand.size(); ++i) {
      auto up = x.q, down = x.q;
      const double d = 1e-5;
      up[i] += d;
      down[i] -= d;
      EXPECT_NEAR(by_hand[i], (problem.potential(up, 0.0) - problem.potential(down, 0.0)) / (2 * d),
                  1e-6 * (1 + size(x)));
    }
  }
}

/// Velocity is ∂H/∂p, the force is −∂H/∂q, both by differentiating the Hamiltonian itself.
template <template <class> class P>
void equations_are_hamiltons() {
  const P<double> problem;
  constexpr int n = P<double>::dof;
  for (const auto& x : states<P>()) {
    Vec<n, Dual<double, 2 * n>> q, p;
    for (int i = 0; i < n; ++i) {
      q[std::size_t(i)] = Dual<double, 2 * n>::variable(x.q[std::size_t(i)], i);
      p[std::size_t(i)] = Dual<double, 2 * n>::variable(x.p[std::size_t(i)], n + i);
    }
    const auto slope = hamiltonian(problem, q, p, 0.0).slope;
    const auto d = derivative(problem, x);
    for (std::size_t i = 0; i < n; ++i) {
      EXPECT_NEAR(d.q[i], slope[n + i], 1e-13 * (1 + size(d)));
      EXPECT_NEAR(d.p[i], -slope[i], 1e-13 * (1 + size(d)));
    }
  }
}

/// dI/dt = ∇I·(q̇, ṗ) vanishes for what the card calls invariant.
template <template <class> class P>
void invariants_are_conserved() {
  const P<double> problem;
  using D = Dual<double, 1>;
  const std::size_t named = About<P>::card().invariants.size();
  if constexpr (HasInvariants<P<double>>) {
    for (const auto& x : states<P>()) {
      const auto d = derivative(problem, x);
      Vec<P<double>::dof, D> q, p;
      for (std::size_t i = 0; i < q.size(); ++i) {
        q[i] = D(x.q[i], {d.q[i]});
        p[i] = D(x.p[i], {d.p[i]});
      }
      const auto values = problem.invariants(q, p, 0.0);
      EXPECT_EQ(values.size(), named);
      for (const auto& value : values) EXPECT_NEAR(value.slope[0], 0, 1e-13 * (1 + size(d)));
    }
  } else {
    EXPECT_EQ(named, 0U);
  }
}

/// A closed form agrees with the equations of motion integrated in quad precision.
template <template <class> class P>
void closed_form_is_the_motion() {
  if constexpr (HasExact<P<double>>) {
    const P<double> problem;
    const auto x0 = convert<Quad, Quad>(states<P>()[0]);
    Extrapolation<P<double>> run(problem, x0, 1e-27);
    for (const double ahead : {0.1, 0.37, 1.0}) {
      const Quad t = x0.t + Quad(ahead * About<P>::card().span);
      ASSERT_TRUE(run.advance(t, [] { return true; }));
      const auto exact = problem.exact(x0, t);
      for (std::size_t i = 0; i < P<double>::dof; ++i) {
        EXPECT_LT(double(abs(Quad(exact.q[i] - run.state().q[i]))), 1e-21);
        EXPECT_LT(double(abs(Quad(exact.p[i] - run.state().p[i]))), 1e-21);
      }
    }
  }
}

}  // namespace laws
