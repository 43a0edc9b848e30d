// Laws of numbers with lanes: scenes that move together have the same bits as each of them alone.
#pragma once

#include <gtest/gtest.h>

#include "core/parameters.hpp"
#include "tests/laws/scene.hpp"
#include "tests/support/lanes.hpp"

namespace laws {

using toy::Lanes;

/// Because names a scheme whose step does not treat lanes one by one, and the reason.
template <class S>
struct Because {
  using Scheme = S;
  std::string_view reason;
};
inline constexpr std::string_view newton =
    "solves equations: iterates until the last lane has converged, one status for all of them";
inline constexpr std::string_view own_clock = "sets its own clock: every lane would have a time of its own";
inline constexpr std::string_view boost = "Odeint's error control, on doubles behind a virtual call";
inline constexpr std::tuple exempt{
    Because<VariationalMidpoint>{newton},
    Because<Galerkin4>{newton},
    Because<ContactVariationalMidpoint>{newton},
    Because<ContactGalerkin4>{newton},
    Because<ContactGauss>{newton},
    Because<LiftedSplitting>{"a map of scenes as text, on their tapes, which run one after the other"},
    Because<JacobiMaupertuis>{"a hybrid: changes its unknowns from step to step, each lane would at other times"},
    Because<EnergyMomentum>{own_clock},
    Because<TimeTransformed>{own_clock},
    Because<AdaptiveVerlet>{own_clock},
    Because<Taylor>{own_clock},
    Because<DormandPrince5>{boost},
    Because<Fehlberg78>{boost},
    Because<BulirschStoer>{boost},
};
template <class Scheme>
inline constexpr bool is_exempt = std::apply(
    [](const auto&... entry) {
      return (std::is_same_v<typename std::remove_cvref_t<decltype(entry)>::Scheme, Scheme> || ...);
    },
    exempt);

/// LaneSchemes is the tuple of the schemes that are not exempt.
template <class... Scheme>
auto without_exempt(std::tuple<Scheme...>*) -> decltype(std::tuple_cat(
    std::declval<std::conditional_t<is_exempt<Scheme>, std::tuple<>, std::tuple<Scheme>>>()...));
using LaneSchemes = decltype(without_exempt(static_cast<SchemeList*>(nullptr)));

/// MovesEachLane: the step of the scheme compiles for lanes of scenes and returns a status for each lane.
template <class Scheme, template <class> class P>
concept MovesEachLane = requires(StepperOf<Scheme, P<Lanes>, FullStateOf<P<double>, Lanes>> stepper,
                                 FullStateOf<P<double>, Lanes>& x) {
  { stepper.step(x, 0.1) } -> std::same_as<toy::Statuses>;
};

/// in_lanes() returns the states of the problem as lanes of one state. All lanes share the time of the first state.
template <template <class> class P>
auto in_lanes() {
  auto x = convert<Lanes, double>(states<P>()[0]);
  for (std::size_t lane = 0; lane < toy::width; ++lane)
    for (std::size_t i = 0; i < x.size; ++i) x[i].v[lane] = states<P>()[lane][i];
  return x;
}
template <template <class> class P>
auto in_lane(std::size_t lane) {
  auto y = states<P>()[lane];
  y.t = states<P>()[0].t;
  return y;
}
template <class X, class Y>
void expect_same_bits(const X& lanes, const Y& scalar, std::size_t lane, const std::string& what) {
  for (std::size_t i = 0; i < Y::size; ++i) EXPECT_EQ(lanes[i].v[lane], scalar[i]) << what;
}

template <template <class> class P>
void lanes_through_problem() {
  const P<double> problem;
  const auto x = in_lanes<P>();
  const auto d = derivative(problem, x);
  for (std::size_t lane = 0; lane < toy::width; ++lane) {
    const auto y = in_lane<P>(lane);
    expect_same_bits(d, derivative(problem, y), lane, "derivative");
    if constexpr (HasEnergy<P<double>>) {
      EXPECT_EQ(energy(problem, x).v[lane], energy(problem, y));
    }
    if constexpr (HasFrequency<P<double>>) {
      EXPECT_EQ(problem.frequency_squared(position(x)).v[lane], problem.frequency_squared(position(y)));
    }
    if constexpr (HasInvariants<P<double>>) {
      const auto wide = problem.invariants(x.q, x.p, 0.0);
      const auto narrow = problem.invariants(y.q, y.p, 0.0);
      for (std::size_t i = 0; i < wide.size(); ++i) EXPECT_EQ(wide[i].v[lane], narrow[i]);
    }
  }
}

/// together() returns scenes as one problem whose parameters are lanes; a choice is common to all lanes.
template <template <class> class P>
P<Lanes> together(const std::array<P<double>, toy::width>& scenes) {
  P<Lanes> wide;
  for (std::size_t lane = 0; lane < toy::width; ++lane)
    parameters::for_each_pair(scenes[lane], wide, [&](const auto& from, auto& to) {
      if constexpr (requires { to.v; }) {
        to.v[lane] = from;
      } else {
        to = from;
      }
    });
  return wide;
}
/// together() returns starts as one state in lanes, at the time of the first.
template <class X>
auto together(const std::array<X, toy::width>& starts) {
  auto x = convert<Lanes, double>(starts[0]);
  for (std::size_t lane = 0; lane < toy::width; ++lane)
    for (std::size_t i = 0; i < X::size; ++i) x[i].v[lane] = starts[lane][i];
  return x;
}

/// expect_lone_runs() checks that every lane has the status and the bits of a run alone. Where a lone run fails, its
/// lane stays where it was. It returns the statuses after the last step.
template <class Scheme, template <class> class P, class X>
toy::Statuses expect_lone_runs(const Scheme& scheme, const std::array<P<double>, toy::width>& scenes,
                               const std::array<X, toy::width>& starts, double h, int steps) {
  auto x = together(starts);
  auto y = starts;
  const auto bind = [&](std::size_t lane) {
    y[lane].t = x.t;
    return scheme.bind(scenes[lane], y[lane]);
  };
  auto wide = scheme.bind(together<P>(scenes), x);
  std::array narrow{bind(0), bind(1), bind(2), bind(3)};
  toy::Statuses alone = StepStatus::ok;
  for (int k = 0; k < steps; ++k) {
    const toy::Statuses all = wide.step(x, h);
    x.t += h;
    for (std::size_t lane = 0; lane < toy::width; ++lane) {
      if (alone.of[lane] == StepStatus::ok) alone.of[lane] = narrow[lane].step(y[lane], h);
      y[lane].t = x.t;
      EXPECT_EQ(all.of[lane], alone.of[lane]) << label(scheme) << ", lane " << lane << ", step " << k;
      expect_same_bits(x, y[lane], lane, label(scheme));
    }
  }
  return alone;
}

/// neighbours() returns scenes with every parameter within its range: the first lane has the scene's own, each other
/// lane differs by another part.
template <template <class> class P>
std::array<P<double>, toy::width> neighbours(const P<double>& scene) {
  std::array<P<double>, toy::width> scenes;
  for (std::size_t lane = 0; lane < toy::width; ++lane) {
    scenes[lane] = scene;
    parameters::for_each_number<P>([&](const auto& field) {
      double& value = scenes[lane].*field.member;
      const double change = 0.01 * double(lane) * (std::abs(value) > 0 ? value : 1);
      value += field.range.contains(value + change) ? change : -change;
    });
  }
  return scenes;
}

/// Scenes that differ in parameters and state, moved together, have the bits of each alone: explicit schemes of equal
/// steps, with every composition and splitting.
template <template <class> class P>
void scenes_in_lanes_move_as_alone() {
  const double h = About<P>::card().suggested.at(0).second;
  const auto scenes = neighbours<P>(P<double>{});
  for_each_scheme<P, LaneSchemes>([&](const auto& scheme) {
    static_assert(MovesEachLane<std::remove_cvref_t<decltype(scheme)>, P>);
    const auto status = expect_lone_runs<std::remove_cvref_t<decltype(scheme)>, P>(scheme, scenes, states<P>(), h, 4);
    EXPECT_TRUE(all(succeeded(status))) << label(scheme);
  });
}

template <template <class> class P, class Schemes>
void lanes_through_schemes() {
  const P<double> problem;
  const double h = About<P>::card().suggested.at(0).second;
  for_each_scheme<P, Schemes>([&](const auto& scheme) {
    auto x = in_lanes<P>();
    auto wide = scheme.bind(problem, x);
    for (int k = 0; k < 3; ++k) {
      const StatusOf<Lanes> status = wide.step(x, h);
      ASSERT_TRUE(all(succeeded(status))) << label(scheme);
    }
    for (std::size_t lane = 0; lane < toy::width; ++lane) {
      auto y = in_lane<P>(lane);
      auto narrow = scheme.bind(problem, y);
      for (int k = 0; k < 3; ++k) ASSERT_EQ(narrow.step(y, h), StepStatus::ok);
      expect_same_bits(x, y, lane, label(scheme));
    }
  });
}

}  // namespace laws
