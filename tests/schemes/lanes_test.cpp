// Scenes far apart that move together in lanes: each takes its own branch, and a lane that fails fails alone.
#include "core/problems/cosmological_oscillator.hpp"
#include "core/problems/damped_oscillator.hpp"
#include "core/problems/double_pendulum.hpp"
#include "core/problems/kepler.hpp"
#include "core/problems/lane_emden.hpp"
#include "core/problems/lorenz.hpp"
#include "core/problems/perturbed_kepler.hpp"
#include "core/problems/scalar_field_cosmology.hpp"
#include "core/problems/spin_orbit.hpp"
#include "tests/laws/lane_laws.hpp"

namespace {

using namespace least;
using namespace least::problems;

template <template <class> class P>
using Scenes = std::array<P<double>, toy::width>;
template <template <class> class P>
using Starts = std::array<FullStateOf<P<double>>, toy::width>;

using Statuses = std::array<StepStatus, toy::width>;

/// said() returns the final status of each lane.
template <template <class> class P, class Scheme>
Statuses said(const Scheme& scheme, const Scenes<P>& scenes, const Starts<P>& starts, int steps) {
  return laws::expect_lone_runs<Scheme, P>(scheme, scenes, starts, scheme.step, steps).of;
}
/// Every scheme that fits moves the lanes as runs alone would, and no lane fails.
template <template <class> class P>
void expect_all_go_on(const Scenes<P>& scenes, const Starts<P>& starts, double h, int steps) {
  laws::for_each_scheme<P, laws::LaneSchemes>([&](auto scheme) {
    scheme.step = h;
    EXPECT_EQ(said<P>(scheme, scenes, starts, steps), Statuses{}) << laws::label(scheme);
  });
}
/// The schemes whose steps can fail.
using MayFail = std::tuple<ContactLeapfrog, ContactSplitting>;

TEST(Lanes, ExemptIsWhatHasToBe) {
  std::size_t listed = 0;
  const auto check = [&]<class Scheme>(Scheme*) {
    const bool moves = laws::MovesEachLane<Scheme, Kepler> || laws::MovesEachLane<Scheme, DoublePendulum> ||
                       laws::MovesEachLane<Scheme, PerturbedKepler> || laws::MovesEachLane<Scheme, DampedOscillator> ||
                       laws::MovesEachLane<Scheme, CosmologicalOscillator> || laws::MovesEachLane<Scheme, Lorenz>;
    EXPECT_EQ(laws::is_exempt<Scheme>, !moves) << Scheme::card().id;
    listed += laws::is_exempt<Scheme>;
  };
  [&]<class... Scheme>(std::tuple<Scheme...>*) {
    (check(static_cast<Scheme*>(nullptr)), ...);
  }(static_cast<SchemeList*>(nullptr));
  EXPECT_EQ(listed, std::tuple_size_v<decltype(laws::exempt)>) << "an exempt scheme is none of the list";
  std::apply([](const auto&... entry) { EXPECT_TRUE((!entry.reason.empty() && ...)); }, laws::exempt);
}

TEST(Lanes, SplittingIsChosenForEach) {  // αh on both sides of ½, and below 0
  const FullStateOf<DampedOscillator<>> x{0, {1}, {0.3}, {0.1}};
  expect_all_go_on<DampedOscillator>({{{1, 0.1}, {2, 4.9}, {1, 5.1}, {3, -3}}}, {x, x, x, x}, 0.1, 20);
}

TEST(Lanes, FlowOfTheActionIsChosenForEach) {  // by its series, cos, cosh; γR < 0 with a pole within the step
  const FullStateOf<CosmologicalOscillator<>> x{0, {0.1}, {0.2}, {0.3}};
  const ContactSplitting scheme{0.2};
  EXPECT_EQ(said<CosmologicalOscillator>(scheme, {{{1, 1}, {2, -8}, {3, 50}, {0.1, 0}}}, {x, x, x, x}, 2), Statuses{});
  EXPECT_EQ(said<CosmologicalOscillator>(scheme, {{{1, 1}, {1, -800}, {1, 40}, {1, 0}}}, {x, x, x, x}, 3),
            (Statuses{StepStatus::ok, StepStatus::singular, StepStatus::ok, StepStatus::ok}));
}

TEST(Lanes, PowerOfAStarIsOfEach) {  // on both sides of the zero
  for (const auto after : {AfterZero::stop, AfterZero::continue_, AfterZero::signed_, AfterZero::clamp}) {
    const Scenes<LaneEmden> scenes{{{0, after}, {1, after}, {3, after}, {2, after}}};
    using X = FullStateOf<LaneEmden<>>;
    expect_all_go_on<LaneEmden>(
        scenes, {X{2, {0.1}, {-0.5}, {0}}, {2, {-0.1}, {-0.5}, {0}}, {2, {0.2}, {-0.5}, {0}}, {2, {0.1}, {-0.6}, {0}}},
        0.1, 6);
    EXPECT_EQ(scenes[0].gradient(Vec<1>{-0.5}, 0.0)[0], after == AfterZero::signed_ ? -1
                                                        : after == AfterZero::clamp ? 0
                                                                                    : 1);
  }
}

TEST(Lanes, PeriodIsThatOfEach) {  // of the tables that lone runs have, in the first two lanes
  const FullStateOf<SpinOrbit<>> x{0, {0.1}, {1}, {0}};
  expect_all_go_on<SpinOrbit>(
      {{{0.01, 0.0075, 0.1, 1}, {0.02, 0.01, 0.2, 2}, {0.01, 0.0075, 0.1, 1.4}, {0.01, 0.0075, 0.1, 0.3}}},
      {x, x, x, x}, 0.3141592653589793, 45);
}

/// The third lane fails and no other does. A composition of high order may step across a pole: there the runs alone
/// decide.
template <template <class> class P>
void expect_third_fails(const Scenes<P>& scenes, const Starts<P>& starts) {
  laws::for_each_scheme<P, MayFail>([&](auto scheme) {
    scheme.step = 0.05;
    const Statuses all = said<P>(scheme, scenes, starts, 60);
    if (scheme.composition == Composition::none) {
      EXPECT_EQ(all, (Statuses{StepStatus::ok, StepStatus::ok, StepStatus::singular, StepStatus::ok}))
          << laws::label(scheme);
    }
  });
}
TEST(Lanes, OneThatFailsFailsAlone) {  // s below the repelling point −√(2R/γ): it reaches −∞ in finite time
  using Oscillator = FullStateOf<CosmologicalOscillator<>>;
  expect_third_fails<CosmologicalOscillator>(
      {{{1, 1}, {0.9, 1.1}, {1, 1}, {1.2, 0.7}}},
      {Oscillator{0, {0.5}, {0.3}, {-1}}, {0, {0.4}, {0.3}, {0.5}}, {0, {0.2}, {0}, {-3}}, {0, {1}, {0}, {0}}});
  using Field = FullStateOf<ScalarFieldCosmology<>>;
  expect_third_fails<ScalarFieldCosmology>(
      {{{1, 0, 0.1}, {1.1, 0.1, 0.2}, {1, 0, 0.1}, {0.9, 0.2, 0.1}}},
      {Field{0, {0.5}, {0.3}, {1}}, {0, {0.4}, {0.3}, {2}}, {0, {0.2}, {0}, {-30}}, {0, {1}, {0}, {3}}});
}

TEST(Lanes, APoleOfTheDampingFailsOneAlone) {  // αh = −2.5
  const FullStateOf<DampedOscillator<>> x{0, {1}, {0.3}, {0.1}};
  const Statuses all =
      said<DampedOscillator>(ContactLeapfrog{0.1}, {{{1, 0.1}, {1, -25}, {2, 3}, {1, -19}}}, {x, x, x, x}, 5);
  EXPECT_EQ(all, (Statuses{StepStatus::ok, StepStatus::singular, StepStatus::ok, StepStatus::ok}));
}

/// After a lane has failed, what the stepper remembers still belongs to the state: a shorter step is that of a new
/// stepper.
TEST(Lanes, AFailedLaneCanGoOn) {
  const Scenes<DampedOscillator> scenes{{{1, 0.1}, {1, -25}, {2, 3}, {1, -19}}};
  const FullStateOf<DampedOscillator<>> start{0, {1}, {0.3}, {0.1}};
  const ContactLeapfrog scheme{0.1};
  auto x = laws::together(std::array{start, start, start, start});
  auto wide = scheme.bind(laws::together<DampedOscillator>(scenes), x);
  EXPECT_EQ(wide.step(x, 0.1).of[1], StepStatus::singular);
  const auto between = x;
  EXPECT_TRUE(all(succeeded(wide.step(x, 0.01))));
  for (std::size_t lane = 0; lane < toy::width; ++lane) {
    auto y = start;
    for (std::size_t i = 0; i < y.size; ++i) y[i] = between[i].v[lane];
    EXPECT_EQ(y == start, lane == 1);
    auto narrow = scheme.bind(scenes[lane], y);
    EXPECT_EQ(narrow.step(y, 0.01), StepStatus::ok);
    laws::expect_same_bits(x, y, lane, "after a failure");
  }
}

}  // namespace
