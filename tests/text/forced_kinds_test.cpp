// Forces that are not friction of one coordinate: magnetic forces, follower forces, dry friction.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/forced.hpp"

namespace forced {
namespace {

// F = B v × e_z does no work: a kick rotates the momentum, and the speed is kept, however long the steps.
TEST(ForcedKinds, MagneticForcesTurnTheMomentum) {
  const double b = 3, end = 5;
  const auto free = mechanics_of(with(of(typed_v, {"x", "y"}, {{"b", b}}, "0*x"), {{"x", "b*vy"}, {"y", "-b*vx"}}));
  End last = run(asked(free, "leapfrog", {0, 0, 1, 0.5}, end), 0.5, "kahan_li_6");
  const double c = std::cos(b * end), s = std::sin(b * end);
  EXPECT_NEAR(last.state[2], c + 0.5 * s, 1e-13);
  EXPECT_NEAR(last.state[3], 0.5 * c - s, 1e-13);
  EXPECT_NEAR(last.work, 0, 1e-14);
  EXPECT_LT(last.balance, 1e-14);

  // In a field that depends on the position, with a trap, the energy is that of H.
  const auto trapped = mechanics_of(
      with(of(typed_v, {"x", "y"}, {{"b", b}}, "(x^2 + y^2)/2"), {{"x", "b*(1 + x^2)*vy"}, {"y", "-b*(1 + x^2)*vx"}}));
  Request exact = asked(trapped, "taylor", {1, 0, 0, 0.5}, end);
  const End truth = run(exact);
  EXPECT_LT(truth.balance, 1e-12);
  last = run(asked(trapped, "leapfrog", {1, 0, 0, 0.5}, end), 0.01, "kahan_li_8");
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(last.state[i], truth.state[i], 1e-10) << i;
  EXPECT_NEAR(last.work, 0, 1e-12);
  EXPECT_LT(run(asked(trapped, "leapfrog", {1, 0, 0, 0.5}, 500), 0.02, "").balance, 1e-2) << "over 2,000 gyrations";
}

// Ziegler's column: two rods, springs in the joints, and a force p along the upper rod, which has no potential. The
// column is stable for p < 2.086 and flutters beyond. Source: Ziegler, Ing.-Arch. 20, 49 (1952), with masses 2 and 1,
// unit lengths and stiffness.
TEST(ForcedKinds, AFollowingForceMakesAColumnFlutter) {
  const auto column = [](double p) {
    return mechanics_of(
        with(of(typed_l, {"a", "b"}, {{"p", p}}, "3*va^2/2 + vb^2/2 + cos(a - b)*va*vb - a^2/2 - (b - a)^2/2"),
             {{"a", "p*sin(a - b)"}}));
  };
  const auto size_after = [&](double p) {
    Request request = asked(column(p), "variational_midpoint", {1e-6, 0}, 200);
    runs::set(request, "step", 0.05);
    const End last = run(request);
    return std::abs(last.state[0]) + std::abs(last.state[1]);
  };
  EXPECT_LT(size_after(2.0), 1e-4);
  EXPECT_GT(size_after(2.4), 1e-2);

  const End truth = run(asked(column(2.4), "taylor", {0.5, 0.2}, 20));
  EXPECT_GT(std::abs(truth.work), 0.1);
  EXPECT_LT(truth.balance, 1e-10);
  const End last = run(asked(column(2.4), "galerkin_4", {0.5, 0.2}, 20), 0.005, "");
  EXPECT_NEAR(last.work, truth.work, 1e-6);
}

// Dry friction −c sign(v) has a vanishing derivative, but is not linear: while the body slides it takes c from p per
// time.
TEST(ForcedKinds, DryFrictionTakesTheSameAtEverySpeed) {
  const auto sliding = mechanics_of(with(of(typed_v, {"x"}, {{"c", 0.5}}, "0*x"), {{"x", "-c*sign(vx)"}}));
  for (const char* scheme : {"leapfrog", "variational_midpoint", "taylor"}) {
    const End last = run(asked(sliding, scheme, {0, 2}, 3));
    EXPECT_NEAR(last.state[1], 0.5, 1e-12) << scheme;
    EXPECT_NEAR(last.work, -0.5 * last.state[0], 1e-12) << scheme;
    EXPECT_NEAR(last.state[0], 3.75, 1e-12) << scheme;
  }
}

// A body that has come to rest stays while the other forces are weaker than friction: kicks handle that, other schemes
// warn.
TEST(ForcedKinds, DryFrictionHoldsWhatIsAtRest) {
  const auto sliding = mechanics_of(with(of(typed_v, {"x"}, {{"c", 0.5}}, "0*x"), {{"x", "-c*sign(vx)"}}));
  EXPECT_NE(sliding->card().summary.find("jumps with the velocity"), std::string::npos);
  for (const char* scheme : {"leapfrog", "symplectic_euler"}) {
    Request request = asked(sliding, scheme, {0, 2}, 10);
    runs::set(request, "step", 0.3);  // no step ends where it comes to rest, at t = 4
    const End last = run(request);
    EXPECT_EQ(last.state[1], 0) << scheme;
    EXPECT_NEAR(last.state[0], 4, scheme[0] == 'l' ? 0.02 : 0.4) << scheme;
    EXPECT_LT(last.balance, 1e-12) << scheme;
  }
  const auto stopped = runs::go(asked(sliding, "variational_midpoint", {0, 2}, 10)).outcome;
  ASSERT_EQ(stopped.warnings.size(), 1U);
  EXPECT_EQ(stopped.warnings[0].code, "force_jumps");
  EXPECT_NEAR(stopped.t, 4, 0.02);
  const auto drag = mechanics_of(with(of(typed_v, {"x"}, {{"c", 0.5}}, "x^2/2"), {{"x", "-c*vx*abs(vx)"}}));
  EXPECT_EQ(drag->card().summary.find("jumps with the velocity"), std::string::npos) << "|v| does not";
}

// Friction between two bodies: the one at rest is dragged along, and their total momentum is kept. Whether friction
// holds a body is decided with the actual velocity of the other one.
TEST(ForcedKinds, DryFrictionBetweenBodiesDragsTheOneAtRest) {
  const auto dragged = mechanics_of(
      with(of(typed_v, {"x", "y"}, {{"c", 0.3}}, "0*x*y"), {{"x", "-c*sign(vx-vy)"}, {"y", "c*sign(vx-vy)"}}));
  const auto pushed =
      mechanics_of(with(of(typed_v, {"x", "y"}, {{"c", 0.3}}, "0*x*y"), {{"x", "-c"}, {"y", "if(vx>vy,c,0)"}}));
  EXPECT_NE(dragged->card().summary.find("know what it holds at rest"), std::string::npos);
  EXPECT_NE(pushed->card().summary.find("velocities of others"), std::string::npos);
  for (const auto& mechanics : {dragged, pushed})
    for (const char* scheme : {"leapfrog", "symplectic_euler"})
      for (const double vy : {0.0, -0.1}) {  // from rest, and through it
        const End last = run(asked(mechanics, scheme, {0, 0, 1, vy}, 1));
        EXPECT_NEAR(last.state[2], 0.7, 1e-12) << scheme << vy;
        EXPECT_NEAR(last.state[3], vy + 0.3, 1e-12) << scheme << vy;
        EXPECT_NEAR(last.state[1], vy + 0.15, scheme[0] == 'l' ? 1e-12 : 2e-3) << scheme << vy;
        EXPECT_LT(last.balance, 1e-12) << scheme << vy;
      }
}

// A block on a board, of the masses 1 and 2: once they have the same velocity they move together, until the force on
// the block is more than friction passes on to the board.
TEST(ForcedKinds, DryFrictionHoldsBodiesTogether) {
  const auto masses = [](Definition d) {
    d.masses = {{"x", "1"}, {"y", "2"}};
    return d;
  };
  const Definition::Named between{{"x", "-c*sign(vx-vy)"}, {"y", "c*sign(vx-vy)"}};
  const auto sliding = mechanics_of(with(masses(of(typed_v, {"x", "y"}, {{"c", 0.3}}, "0*x*y")), between));
  for (const char* scheme : {"leapfrog", "symplectic_euler"}) {
    Request request = asked(sliding, scheme, {0, 0, 1, 0}, 5);
    runs::set(request, "step", 0.03);
    const End last = run(request);
    const double meet = 1 / 0.45, near = scheme[0] == 'l' ? 1e-3 : 0.03;
    EXPECT_NEAR(last.state[0], meet - 0.15 * meet * meet + (5 - meet) / 3, near) << scheme;
    EXPECT_NEAR(last.state[1], 0.075 * meet * meet + (5 - meet) / 3, near) << scheme;
    EXPECT_NEAR(last.state[2], 1.0 / 3, 1e-12) << scheme;
    EXPECT_NEAR(last.state[3], 2.0 / 3, 1e-12) << scheme;
    EXPECT_LT(last.balance, 1e-12) << scheme;
  }
  const double b = 0.2, c = 0.3, slip = 1.5 * c / b, end = 4;
  const auto pulled =
      mechanics_of(with(masses(of(typed_v, {"x", "y"}, {{"b", b}, {"c", c}}, "-b*t*x + 0*y")), between));
  Request request = asked(pulled, "leapfrog", {0, 0, 0, 0}, end);
  runs::set(request, "step", 0.01);
  const End last = run(request);
  const double together = b * slip * slip / 6, free = end - slip;
  EXPECT_NEAR(last.state[2], together + b * (end * end - slip * slip) / 2 - c * free, 1e-4);
  EXPECT_NEAR(last.state[3], 2 * together + c * free, 1e-4);
  // Of three bodies in a row, whether two stick depends on the third: no scheme handles that.
  const auto three =
      mechanics_of(with(of(typed_v, {"x", "y", "z"}, {}, "0*x*y*z"),
                        {{"x", "-sign(vx-vy)"}, {"y", "sign(vx-vy) - sign(vy-vz)"}, {"z", "sign(vy-vz)"}}));
  EXPECT_NE(three->card().summary.find("velocities of others"), std::string::npos);
}

// Friction in proportion to another velocity holds a body against a force of 0.1 while that velocity is large enough:
// p_y = 1 − t/4 falls to 1/3 at t = 8/3; from there on ṗ_x = 0.1 − 0.3 p_y, which adds up to 3 (t − 8/3)²/80.
TEST(ForcedKinds, DryFrictionThatGrowsWithAnotherVelocityHolds) {
  const auto held =
      mechanics_of(with(of(typed_v, {"x", "y"}, {{"b", 0.25}}, "-0.1*x + b*y"), {{"x", "-0.3*sign(vx)*abs(vy)"}}));
  for (const double end : {2.0, 3.5}) {
    Request request = asked(held, "leapfrog", {0, 0, 0, 1}, end);
    runs::set(request, "step", 0.01);
    const End last = run(request);
    const double free = std::max(0.0, end - 8.0 / 3);
    if (end == 2)
      EXPECT_EQ(last.state[0], 0);
    else
      EXPECT_NEAR(last.state[2], 3 * free * free / 80, 1e-3);
    EXPECT_NEAR(last.state[3], 1 - end / 4, 1e-12);
    EXPECT_LT(last.balance, 1e-6);
  }
  // The body slides until it rests: p_x = 1 − 0.3 t ends at t = 10/3.
  const auto sliding = mechanics_of(with(of(typed_v, {"x", "y"}, {}, "0*x*y"), {{"x", "-0.3*sign(vx)*abs(vy)"}}));
  Request request = asked(sliding, "leapfrog", {0, 0, 1, 1}, 5);
  runs::set(request, "step", 0.3);
  const End last = run(request);
  EXPECT_EQ(last.state[2], 0);
  EXPECT_NEAR(last.state[0], 1 / 0.6, 0.02);
}

// A block that a spring pulls, whose other end moves at a constant speed u: it sticks until the spring outweighs
// friction, at t₁ = c/(ku), then x = u(t − t₁) − (u/ω) sin ω(t − t₁), at rest for an instant once a period.
TEST(ForcedKinds, WhatIsHeldStartsWhenThePullOutweighsFriction) {
  const double k = 4, u = 0.3, c = 0.9, omega = 2, first = c / (k * u);
  const auto pulled =
      mechanics_of(with(of(typed_v, {"x"}, {{"k", k}, {"u", u}, {"c", c}}, "k*(x - u*t)^2/2"), {{"x", "-c*sign(vx)"}}));
  const auto error = [&](double step) {
    double most = 0;
    for (const double since : {-0.1, 1.0, 2.5, 5.0}) {
      Request request = asked(pulled, "leapfrog", {0, 0}, first + since);
      runs::set(request, "step", step);
      const double x = since < 0 ? 0 : u * since - u / omega * std::sin(omega * since);
      const End last = run(request);
      most = std::max(most, std::abs(last.state[0] - x));
      if (since < 0) {
        EXPECT_EQ(last.state[0], 0);
        EXPECT_EQ(last.state[1], 0);
      }
    }
    return most;
  };
  const double coarse = error(0.02), fine = error(0.005);
  EXPECT_LT(coarse, 2e-3);
  EXPECT_LT(fine, coarse / 3) << coarse;
  EXPECT_GT(fine, 1e-9);
}

}  // namespace
}  // namespace forced
