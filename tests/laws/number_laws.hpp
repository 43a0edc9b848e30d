// Laws of a problem's description: it is generic in the number type, and where it states something twice both agree.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <vector>

#include "core/from_values.hpp"
#include "core/parameters.hpp"
#include "core/schemes/taylor.hpp"
#include "core/tape/unrolled.hpp"
#include "tests/laws/scene.hpp"

namespace laws {

/// recorded_as() checks that the equations of motion can be recorded on a tape, at compile time too; that order 1 of
/// their Taylor series is their value; and that a series whose program the compiler has unrolled gives the same bits as
/// one whose program is interpreted.
template <template <class> class P, class X>
void recorded_as(bool in_catalogue) {
  static_assert([] {
    tape::Tape tape;
    return taylor::write_equations<X>(P<double>{}, tape)[0] >= 0 && tape.size() > int(StateOf<P<double>>::size);
  }());
  const auto program = taylor::record<X>(P<double>{});
  tape::Series read(program, 12, false), known(program, 12);
  EXPECT_FALSE(read.unrolled());
  EXPECT_EQ(known.unrolled(), in_catalogue && !tape::unrolled_series().empty());
  for (const auto& full : states<P>()) {
    std::array<double, taylor::components<X>> y;
    for (std::size_t i = 0; i < y.size(); ++i) y[i] = full[i];
    tape::Series plain(program, 12, false);
    plain.expand(y.data(), full.t);
    for (const bool begun : {false, true})
      for (tape::Series* series : {&read, &known}) {
        if (begun) series->defined(y.data(), full.t);
        series->expand(y.data(), full.t);
        for (int k = 0; k <= plain.order(); ++k)
          for (std::size_t i = 0; i < y.size(); ++i)
            EXPECT_EQ(std::bit_cast<std::uint64_t>(series->coefficients(k)[i]),
                      std::bit_cast<std::uint64_t>(plain.coefficients(k)[i]))
                << "order " << k << " of variable " << i;
        for (const auto* asked : {&program.switches, &program.poles})
          for (const tape::Index value : *asked)
            for (int k = 0; k < plain.order(); ++k)
              EXPECT_EQ(series->coefficient(value, k), plain.coefficient(value, k)) << "order " << k;
      }
    const auto d = derivative(P<double>{}, full);
    for (std::size_t i = 0; i < y.size(); ++i) EXPECT_NEAR(read.coefficients(1)[i], d[i], 1e-14 * (1 + std::abs(d[i])));
  }
}
template <template <class> class P>
void recorded(bool in_catalogue = false) {
  recorded_as<P, StateOf<P<double>>>(in_catalogue);
  recorded_as<P, FullStateOf<P<double>>>(in_catalogue);
}

/// Probes has one scheme for each thing that a problem can offer. tests/schemes runs the other schemes with other
/// numbers on some problems of each kind.
using Probes = std::tuple<RungeKutta4, Leapfrog, VariationalMidpoint, ContactSplitting>;

/// Parameters may be dual numbers: the derivative of a step by each of them agrees with a difference quotient.
template <template <class> class P, class Schemes = Probes>
void parameters_can_be_dual() {
  using D = Dual<double, 1>;
  const double h = coarse_step<P>(), small = 1e-5;
  const auto start = states<P>()[0];
  const auto step = [&](const auto& scheme, const auto& problem, auto x) {
    auto stepper = scheme.bind(problem, x);
    EXPECT_EQ(stepper.step(x, h), StepStatus::ok);
    return x;
  };
  for_each_scheme<P, Schemes>([&](const auto& scheme) {
    parameters::for_each_number<P>([&](const auto& field) {
      P<double> more, less;
      more.*field.member += small;
      less.*field.member -= small;
      const auto up = step(scheme, more, start), down = step(scheme, less, start);
      auto wide = parameters::in<D>(P<double>{});
      parameters::with_member(wide, field, [](D& parameter) { parameter.slope[0] = 1; });
      const auto y = step(scheme, wide, convert<D, double>(start));
      for (std::size_t i = 0; i < start.size; ++i)
        EXPECT_NEAR(y[i].slope[0], (up[i] - down[i]) / (2 * small), 1e-7 * (size(start) + std::abs(y[i].slope[0])))
            << label(scheme) << ' ' << field.name;
    });
  });
}

template <template <class> class P>
void force_is_minus_gradient() {
  const P<double> problem;
  if constexpr (!Potential<P<double>>)
    return;
  else
    for (const auto& x : states<P>()) {
      const auto f = phase(problem, x.t);
      const auto by_hand = gradient(problem, x.q, f);
      const auto derived = problem.potential(seed<P<double>::dof, double>(x.q), f).slope;
      for (std::size_t i = 0; i < by_hand.size(); ++i)
        EXPECT_NEAR(by_hand[i], derived[i], 1e-13 * (1 + std::abs(derived[i])));
      if constexpr (HasLogGradient<P<double>, double>) {
        const auto stated = problem.log_gradient(x.q, 3.0);
        for (std::size_t i = 0; i < by_hand.size(); ++i)
          EXPECT_NEAR(stated[i], 3 * by_hand[i] / problem.potential(x.q, f), 1e-13 * (1 + std::abs(stated[i])));
      }
      // The potential itself against a difference quotient, so that the derivative of a wrong branch is not taken for
      // the truth.
      for (std::size_t i = 0; i < by_hand.size(); ++i) {
        auto up = x.q, down = x.q;
        const double d = 1e-5;
        up[i] += d;
        down[i] -= d;
        EXPECT_NEAR(by_hand[i], (problem.potential(up, f) - problem.potential(down, f)) / (2 * d),
                    1e-6 * (1 + size(x)));
      }
    }
}

template <template <class> class P>
void damping_is_the_slope_of_its_integral() {
  if constexpr (HasDampingIntegral<P<double>>) {
    const P<double> problem;
    for (const auto& x : states<P>()) {
      const double rate = damping(problem, phase(problem, x.t)), d = 1e-5;
      const double derived = problem.damping_integral(Dual<double, 1>(x.t, {1.0})).slope[0];
      EXPECT_NEAR(rate, derived, 1e-13 * (1 + std::abs(rate)));
      EXPECT_NEAR(rate, (problem.damping_integral(x.t + d) - problem.damping_integral(x.t - d)) / (2 * d), 1e-8);
    }
  }
}

/// q̇ = H_p, ṗ = −H_q − p H_s, ṡ = p·H_p − H, by differentiating the Hamiltonian itself. A flow that is split is the
/// sum of its pieces, and each piece is a flow: over h twice it goes where it goes over 2h, and over −h it comes back.
template <template <class> class P>
void equations_are_hamiltons() {
  const P<double> problem;
  for (const auto& x : states<P>()) {
    const auto d = derivative(problem, x);
    if constexpr (Potential<P<double>>) {
      constexpr std::size_t n = P<double>::dof;
      using D = Dual<double, int(x.size)>;
      auto y = convert<D, double>(x);
      for (std::size_t i = 0; i < x.size; ++i) y[i] = D::variable(x[i], int(i));
      const auto h = energy(problem, y);
      double action = -h.value, by_s = 0;
      if constexpr (x.acting) by_s = h.slope[2 * n];
      for (std::size_t i = 0; i < n; ++i) {
        EXPECT_NEAR(d.q[i], h.slope[n + i], 1e-13 * (1 + size(d)));
        EXPECT_NEAR(d.p[i], -h.slope[i] - x.p[i] * by_s, 1e-13 * (1 + size(d)));
        action += x.p[i] * h.slope[n + i];
      }
      if constexpr (x.acting) {
        EXPECT_NEAR(d.action.s, action, 1e-13 * (1 + size(d)));
      }
    } else {
      auto sum = decltype(x.y){};
      const double h = 0.01;
      [&]<int... I>(std::integer_sequence<int, I...>) {
        const auto add = [&](auto piece) {
          using D = Dual<double, 1>;
          const auto lifted = convert<D, D>(x).y;
          const auto moved = problem.flow(piece, lifted, D(0.0, {1.0}), x.t);
          for (std::size_t i = 0; i < x.size; ++i) sum[i] += moved[i].slope[0];
          const auto once = problem.flow(piece, x.y, h, x.t), twice = problem.flow(piece, once, h, x.t);
          const auto whole = problem.flow(piece, x.y, 2 * h, x.t), back = problem.flow(piece, once, -h, x.t);
          for (std::size_t i = 0; i < x.size; ++i) {
            EXPECT_NEAR(twice[i], whole[i], 1e-13 * size(x)) << piece;
            EXPECT_NEAR(back[i], x.y[i], 1e-13 * size(x)) << piece;
          }
        };
        (add(Piece<I>{}), ...);
      }
      (std::make_integer_sequence<int, P<double>::pieces>{});
      for (std::size_t i = 0; i < x.size; ++i) EXPECT_NEAR(sum[i], d[i], 1e-13 * (1 + size(d)));
    }
  }
}

/// dI/dt = ∇I·(q̇, ṗ) + I_t vanishes for every quantity that the card calls invariant.
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
      const auto values = problem.invariants(q, p, D(x.t, {1.0}));
      EXPECT_EQ(values.size(), named);
      for (const auto& value : values) EXPECT_NEAR(value.slope[0], 0, 1e-13 * (1 + size(d)));
    }
  } else {
    EXPECT_EQ(named, 0U);
  }
}

/// A closed form, where it applies, agrees with the equations of motion integrated in quad precision, with the
/// parameters of the card or of one of its presets. From a singular start the closed form itself leads to a regular
/// one.
template <template <class> class P>
void closed_form_is_the_motion() {
  if constexpr (HasExact<P<double>>) {
    constexpr bool singular_start = HasSeries<P<double>>;
    StateOf<P<double>> start;
    assign(start, singular_start ? default_start<P>() : states<P>()[0]);
    int applied = 0;
    const auto check = [&](const P<double>& problem) {
      if constexpr (requires { problem.exact_applies(start); })
        if (!problem.exact_applies(start)) return;
      ++applied;
      const auto x0 = convert<Quad, Quad>(start);
      auto from = x0;
      if (singular_start) assign(from, problem.exact(x0, Quad(1)));
      Extrapolation<P<double>> run(problem, from, 1e-27);
      for (const double ahead : {0.1, 0.37, 1.0}) {
        const Quad t = from.t + Quad(ahead * (singular_start ? 1 : About<P>::card().span));
        ASSERT_TRUE(run.advance(t, [] { return true; }));
        const auto exact = problem.exact(x0, t);
        for (std::size_t i = 0; i < P<double>::dof; ++i) {
          EXPECT_LT(double(abs(Quad(exact.q[i] - run.state().q[i]))), 1e-21);
          EXPECT_LT(double(abs(Quad(exact.p[i] - run.state().p[i]))), 1e-21);
        }
      }
    };
    check(P<double>{});
    const auto cards = parameter_cards(About<P>::fields);
    for (const PresetCard& preset : About<P>::card().presets) {
      std::vector<double> values;
      for (const ParameterCard& parameter : cards) {
        const auto own = std::ranges::find(preset.parameters, parameter.name, &NamedValue::first);
        values.push_back(own == preset.parameters.end() ? parameter.value : own->second);
      }
      check(from_values<P<double>>(About<P>::fields, values));
    }
    EXPECT_GT(applied, 0) << "the closed form was not examined";
  }
}

}  // namespace laws
