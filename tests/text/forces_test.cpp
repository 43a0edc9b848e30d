// Forces beside a Lagrangian, a Hamiltonian or a potential: orders of schemes and of the balance of energy and work,
// and motions known in closed form.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/forced.hpp"

namespace forced {
namespace {

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0;
  for (std::size_t i = 0; i < b.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

/// Expected is a scheme with the order of its states; its balance H − H₀ − W has the same order, or is kept to
/// round-off.
struct Expected {
  const char *scheme, *composition;
  double order, step;
};
void has_order(const Definition& definition, const std::vector<double>& start, const Expected& expected) {
  constexpr double end = 4;
  const std::string label = definition.formula + " by " + expected.scheme + " " + expected.composition;
  const auto mechanics = mechanics_of(definition);
  Request exact = asked(mechanics, "taylor", start, end);
  runs::set(exact, "tolerance", 1e-16);
  const auto truth = run(exact).state;
  double errors[2], balances[2];
  for (const int half : {0, 1}) {
    const End last =
        run(asked(mechanics, expected.scheme, start, end), expected.step / (1 + half), expected.composition);
    errors[half] = distance(last.state, truth);
    balances[half] = last.balance;
  }
  EXPECT_GT(errors[1], 1e-13) << label << " is not at round-off";
  EXPECT_NEAR(std::log2(errors[0] / errors[1]), expected.order, 0.2) << label;
  if (balances[0] > 1e-13) {
    EXPECT_NEAR(std::log2(balances[0] / balances[1]), expected.order, 0.2) << label;
  }
}

constexpr Expected splittings[] = {{"symplectic_euler", "", 1, 0.01},
                                   {"leapfrog", "", 2, 0.04},
                                   {"leapfrog", "suzuki_4", 4, 0.08},
                                   {"leapfrog", "kahan_li_6", 6, 0.08},
                                   {"leapfrog", "kahan_li_8", 8, 0.1}};
constexpr Expected rules[] = {{"variational_midpoint", "", 2, 0.04},
                              {"variational_midpoint", "kahan_li_6", 6, 0.08},
                              {"galerkin_4", "", 4, 0.08},
                              {"runge_kutta_4", "", 4, 0.01}};

/// A force linear in each coordinate's own velocity: kicks are exact.
Definition linear() { return with(of(typed_v, {"x"}, {}, "x^4/4"), {{"x", "-0.1*vx*(1 + x^2) + 0.3*cos(t)"}}); }
/// A metric that is not diagonal, and friction between the coordinates that depends on position: exponentials of
/// matrices.
Definition coupled() {
  return with(of(typed_l, {"x", "y"}, {}, "vx^2/2 + vy^2 + 0.3*vx*vy - x^4/4 - y^2 - x*y"), {},
              "0.2*(vx - vy)^2/2 + 0.1*x^2*vx^2");
}
/// Forces that are not linear: kicks by the implicit midpoint rule, for each momentum alone or for both.
Definition cubic() { return with(of(typed_v, {"x"}, {}, "x^4/4"), {{"x", "-0.1*vx^3"}}); }
Definition coupled_cubic() {
  return with(of(typed_l, {"x", "y"}, {}, "vx^2/2 + vy^2 - x^4/4 - y^2 - x*y"), {}, "0.2*(vx - vy)^4/4");
}

TEST(Forces, SchemesKeepTheirOrders) {
  for (const auto& definition : {linear(), cubic()})
    for (const auto& expected : splittings) has_order(definition, {2, 0}, expected);
  for (const auto& definition : {coupled(), coupled_cubic()}) {
    for (const auto& expected : splittings) has_order(definition, {2, 0, 0, 1}, expected);
    for (const auto& expected : rules) has_order(definition, {2, 0, 0, 1}, expected);
  }
  for (const auto& definition : {linear(), coupled()})
    has_order(definition, definition.variables.size() == 1 ? std::vector{2.0, 0.0} : std::vector{2.0, 0.0, 0.0, 1.0},
              {"ruth_3", "", 3, 0.04});
  for (const auto& expected : rules) has_order(double_pendulum(), {2, 1, 0, 0}, expected);
}

// Without a potential only kicks change a momentum: a run is exact, however long its steps.
TEST(Forces, KicksAreExactWhereFrictionIsLinear) {
  const double c = 0.7, end = 6;
  const Definition alone = with(of(typed_v, {"x"}, {{"c", c}}, "0*x"), {{"x", "-c*vx"}});
  End last = run(asked(alone, "leapfrog", {0, 2}, end), 0.5, "kahan_li_6");
  EXPECT_NEAR(last.state[1], 2 * std::exp(-c * end), 1e-14);
  EXPECT_NEAR(last.work, 2 * (std::exp(-2 * c * end) - 1), 1e-14);
  EXPECT_LT(last.balance, 1e-14);

  // With masses 1 and 2 the relative velocity decays with c/μ, μ = 2/3; the total momentum stays 1.
  const Definition two = with(of(typed_l, {"x", "y"}, {{"c", c}}, "vx^2/2 + vy^2"), {}, "c*(vx - vy)^2/2");
  last = run(asked(two, "leapfrog", {0, 0, 3, -2}, end), 0.5, "yoshida_4");
  const double relative = 4 * std::exp(-c * 1.5 * end), mean = 1.0 / 3;
  EXPECT_NEAR(last.state[2], mean + relative * 2 / 3, 1e-13);
  EXPECT_NEAR(last.state[3], 2 * (mean - relative / 3), 1e-13);
  EXPECT_NEAR(last.work, (relative * relative - 16) / 3, 1e-13);
  EXPECT_LT(last.balance, 1e-13);

  // Friction so strong that the motion ends within a kick; the matrix has the norm 1e6.
  const Definition strong = with(of(typed_l, {"x", "y"}, {}, "vx^2/2 + vy^2"), {}, "1e6*(vx - vy)^2/2");
  last = run(asked(strong, "leapfrog", {0, 0, 3, -2}, end), 0.5, "");
  EXPECT_NEAR(last.state[2], mean, 1e-9);
  EXPECT_NEAR(last.work, -16.0 / 3, 1e-9);
}

TEST(Forces, QuadraticDragIsKnownInClosedForm) {
  const double c = 0.3, v = 2, end = 10;
  const auto slowed = mechanics_of(with(of(typed_v, {"x"}, {{"c", c}}, "0*x"), {{"x", "-c*vx*abs(vx)"}}));
  const auto close = [&](const End& last, double tolerance) {
    EXPECT_NEAR(last.state[0], std::log1p(c * v * end) / c, tolerance);
    EXPECT_NEAR(last.state[1], v / (1 + c * v * end), tolerance);
    EXPECT_NEAR(last.work, 0.5 * v * v * (1 / std::pow(1 + c * v * end, 2) - 1), tolerance);
  };
  close(run(asked(slowed, "leapfrog", {0, v}, end), 0.1, "kahan_li_8"), 1e-12);
  close(run(asked(slowed, "taylor", {0, v}, end)), 1e-11);
  close(run(asked(slowed, "galerkin_4", {0, v}, end), 0.02, ""), 1e-8);

  // A fall from rest: v = w tanh(gt/w), w² = mg/c.
  const double m = 2, g = 9.81, w = std::sqrt(m * g / c);
  Definition falling = with(of(typed_v, {"x"}, {{"c", c}, {"g", g}, {"m", m}}, "m*g*x"), {{"x", "-c*vx*abs(vx)"}});
  falling.masses = {{"x", "m"}};
  for (const char* scheme : {"taylor", "dormand_prince_5"}) {
    Request request = asked(falling, scheme, {0}, 3);
    runs::set(request, "tolerance", 1e-13);
    EXPECT_NEAR(run(request).state[1], -m * w * std::tanh(g * 3 / w), 1e-10) << scheme;
  }
}

// The work of the joint is −∫2D dt, by the derived equations as a scene of their own with one more variable.
TEST(Forces, FrictionInAJointTakesTwiceTheDissipation) {
  const auto mechanics = mechanics_of(double_pendulum());
  auto equations = mechanics->text()->equations();
  equations.emplace_back("w", "c*(vb - va)^2");
  Request all = typed_as(runs::defaults("kepler", "taylor"),
                         mechanics_of(flow({"a", "b", "va", "vb", "w"}, {{"c", 0.2}}, equations)));
  begin_at(all, std::array{2.0, 1.0, 0.0, 0.0});
  runs::only_final(all);
  all.end = 10;
  runs::set(all, "tolerance", 1e-15);
  const auto truth = runs::go(all).outcome.final;
  ASSERT_GT(truth[4], 0.5) << "the joint takes something";
  Request request = asked(mechanics, "taylor", {2, 1}, 10);
  runs::set(request, "tolerance", 1e-15);
  End last = run(request);
  for (const std::size_t i : {0, 1}) EXPECT_NEAR(last.state[i], truth[i], 1e-11);
  EXPECT_NEAR(last.work, -truth[4], 1e-11);
  EXPECT_NEAR(last.final_energy - last.initial_energy, -truth[4], 1e-11);
  last = run(asked(mechanics, "variational_midpoint", {2, 1}, 10), 0.02, "kahan_li_6");
  EXPECT_NEAR(last.work, -truth[4], 1e-10);
  EXPECT_LT(last.balance, 1e-10);
}

// A motor turns a pendulum with friction: in the steady state its work is what friction takes, and the angle lags
// behind.
TEST(Forces, AMotorDoesWork) {
  const Definition motor =
      with(of(typed_v, {"q"}, {{"c", 0.1}, {"torque", 0.5}}, "q^2/2"), {{"q", "torque*cos(t) - c*v"}});
  const auto mechanics = mechanics_of(motor);
  EXPECT_FALSE(mechanics->text()->form->autonomous);
  // In resonance the steady state is q = (torque/c) sin t.
  const double pi = 3.14159265358979323846;
  End last = run(asked(mechanics, "leapfrog", {0, 5}, 20 * pi), pi / 50, "kahan_li_8");
  EXPECT_NEAR(last.state[0], 0, 1e-9);
  EXPECT_NEAR(last.state[1], 5, 1e-9);
  EXPECT_NEAR(last.work, 0, 1e-9);
  EXPECT_LT(last.balance, 1e-9);
}

// Forces are written with momenta beside a Hamiltonian, and friction with velocities: both texts give the same motion.
TEST(Forces, LagrangiansAndHamiltoniansSayTheSame) {
  const Definition l =
      with(of(typed_l, {"r", "f"}, {}, "vr^2/2 + r^2*vf^2/2 + 1/r"), {{"f", "-0.1*r^2*vf"}}, "0.05*vr^2");
  const Definition h =
      with(of(typed_h, {"r", "f"}, {}, "pr^2/2 + pf^2/(2*r^2) - 1/r"), {{"f", "-0.1*pf"}, {"r", "-0.1*pr"}});
  const Definition d = with(of(typed_h, {"r", "f"}, {}, "pr^2/2 + pf^2/(2*r^2) - 1/r"), {}, "0.05*(vr^2 + r^2*vf^2)");
  const std::vector<double> start{1, 0, 0.1, 1.2};
  const auto one = run(asked(l, "galerkin_4", start, 5), 0.01, ""),
             other = run(asked(h, "galerkin_4", start, 5), 0.01, ""),
             third = run(asked(d, "galerkin_4", start, 5), 0.01, "");
  EXPECT_LT(distance(one.state, other.state), 1e-11);
  EXPECT_LT(distance(one.state, third.state), 1e-11);
  EXPECT_NEAR(one.work, other.work, 1e-11);
  EXPECT_NEAR(one.state[3], 1.2 * std::exp(-0.5), 1e-8) << "the angular momentum decays";
}

// Forces that vanish leave the maps of schemes unchanged.
TEST(Forces, OfNothingLeaveTheSchemesAsTheyAre) {
  struct Pair {
    Definition free;
    std::vector<double> start;
    std::vector<const char*> schemes;
  };
  const Pair pairs[] = {
      {of(typed_l, {"x", "y"}, {}, "(vx^2 + vy^2)/2 - (x^2 + y^2)/2 - y*(x^2 - y^2/3)"),
       {0.1, 0.2, 0.3, -0.1},
       {"symplectic_euler", "leapfrog", "ruth_3", "variational_midpoint", "galerkin_4", "runge_kutta_4"}},
      {of(typed_l, {"a", "b"}, {}, "va^2 + vb^2/2 + cos(a - b)*va*vb + 2*cos(a) + cos(b)"),
       {1, 0.5, 0, 0},
       {"variational_midpoint", "galerkin_4", "runge_kutta_4"}}};
  for (const auto& [free, start, all] : pairs)
    for (const char* scheme : all)
      for (const char* composition : {"none", "suzuki_4"}) {
        Request request = asked(free, scheme, start, 5);
        Request beside = asked(with(free, {{free.variables[0], "0"}}), scheme, start, 5);
        for (Request* one : {&request, &beside}) {
          runs::set(*one, "step", 0.05);
          if (schemes()[one->scheme].find("composition")) runs::set(*one, "composition", composition);
        }
        auto unforced = runs::go(request).outcome.final;
        runs::drop_unknown(unforced);
        const End last = run(beside);
        EXPECT_LT(distance(unforced, last.state), 1e-12) << free.formula << scheme << composition;
        EXPECT_NEAR(last.work, 0, 1e-17) << scheme;
      }
}

}  // namespace
}  // namespace forced
