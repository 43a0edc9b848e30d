// Closed forms and the quad-precision reference integrator against reference states of 20 digits that were computed
// independently (tests/reference/conservative.json says how).
#include "core/reference/reference.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/number/parse.hpp"
#include "least_problems.hpp"

namespace {

using namespace least;
using namespace least::problems;
using nlohmann::json;

const json& system(const std::string& name) {
  static const json all = [] {
    std::ifstream file(LEAST_SOURCE_DIR "/tests/reference/conservative.json");
    return json::parse(file);
  }();
  for (const auto& entry : all.at("systems"))
    if (entry.at("name") == name) return entry;
  throw std::out_of_range(name);
}

Quad read(const json& text) { return parse<Quad>(text.get<std::string>()); }

template <class P>
StateOf<P, Quad, Quad> start(const json& entry) {
  StateOf<P, Quad, Quad> x;
  for (std::size_t i = 0; i < P::dof; ++i) {
    x.q[i] = read(entry.at("q0").at(i));
    x.p[i] = read(entry.at("p0").at(i));
  }
  return x;
}

/// difference() returns the largest difference from the reference, relative to the larger of 1 and the state.
template <class P>
double difference(const StateOf<P, Quad, Quad>& x, const json& reference) {
  double most = 0, size = 1;
  for (std::size_t i = 0; i < 2 * P::dof; ++i) {
    const Quad truth = read(reference.at("state").at(i)), mine = i < P::dof ? x.q[i] : x.p[i - P::dof];
    most = std::max(most, std::abs(static_cast<double>(mine - truth)));
    size = std::max(size, std::abs(static_cast<double>(truth)));
  }
  return most / size;
}

template <class P>
void check_closed_form(const std::string& name, double tolerance) {
  const json& entry = system(name);
  const auto x0 = start<P>(entry);
  ASSERT_GE(entry.at("states").size(), 4U);
  for (const auto& state : entry.at("states"))
    EXPECT_LT(difference<P>(P{}.exact(x0, read(state.at("t"))), state), tolerance) << name << " at " << state.at("t");
}

template <class P>
void check_integrator(const std::string& name, double tolerance) {
  const json& entry = system(name);
  const P problem;
  Extrapolation<P> run(problem, start<P>(entry), 1e-27);
  ASSERT_GE(entry.at("states").size(), 4U);
  for (const auto& state : entry.at("states")) {
    ASSERT_TRUE(run.advance(read(state.at("t")), [] { return true; }));
    EXPECT_LT(difference<P>(run.state(), state), tolerance) << name << " at " << state.at("t");
  }
}

// The start of the orbits below has 20 digits; a period at high eccentricity magnifies its rounding.
TEST(Reference, KeplerInClosedForm) {
  check_closed_form<Kepler<>>("kepler_seed", 1e-14);  // the last state lies 1,000 periods on
  check_closed_form<Kepler<>>("kepler_seed_retro", 1e-17);
  check_closed_form<Kepler<>>("kepler_hyperbolic", 1e-17);
  check_closed_form<Kepler<>>("kepler_e0.99", 1e-15);
  check_closed_form<Kepler<>>("kepler_e0.999", 1e-14);
  check_closed_form<Kepler<>>("kepler_e0.9999", 1e-12);
}
TEST(Reference, KeplerInSpace) {
  check_closed_form<Kepler3d<>>("kepler_3d", 1e-17);
  check_integrator<Kepler3d<>>("kepler_3d", 1e-17);
}
TEST(Reference, PendulumInClosedForm) {
  check_closed_form<Pendulum<>>("pendulum_libration", 1e-17);
  check_closed_form<Pendulum<>>("pendulum_rotation", 1e-17);
}
TEST(Reference, HenonHeiles) { check_integrator<HenonHeiles<>>("henon_heiles", 1e-17); }
TEST(Reference, DoublePendulum) {
  check_integrator<DoublePendulum<>>("double_pendulum_mild", 1e-18);
  check_integrator<DoublePendulum<>>("double_pendulum_strong", 1e-17);  // chaotic
}

// ---- closed forms where they are special

template <class P>
StateOf<P, Quad, Quad> at(std::initializer_list<double> q, std::initializer_list<double> p) {
  StateOf<P, Quad, Quad> x;
  std::copy(q.begin(), q.end(), x.q.begin());
  std::copy(p.begin(), p.end(), x.p.begin());
  return x;
}
template <class P>
void agrees_with_integrator(const StateOf<P, Quad, Quad>& x0, double t, double tolerance) {
  const P problem;
  Extrapolation<P> run(problem, x0, 1e-27);
  ASSERT_TRUE(run.advance(Quad(t), [] { return true; }));
  const auto exact = problem.exact(x0, Quad(t));
  for (std::size_t i = 0; i < P::dof; ++i) {
    EXPECT_LT(std::abs(double(exact.q[i] - run.state().q[i])), tolerance);
    EXPECT_LT(std::abs(double(exact.p[i] - run.state().p[i])), tolerance);
  }
}

TEST(ClosedForm, KeplerParabolaCircleAndBackwards) {
  agrees_with_integrator<Kepler<>>(at<Kepler<>>({2, 0}, {0, 1}), 30, 1e-22);  // E = 0
  agrees_with_integrator<Kepler<>>(at<Kepler<>>({2, 0}, {0.3, 0.95}), 30, 1e-22);
  const auto circle = Kepler<>{}.exact(at<Kepler<>>({1, 0}, {0, 1}), Quad(1));
  EXPECT_LT(std::abs(double(circle.q[0]) - std::cos(1.0)), 1e-16);
  EXPECT_LT(std::abs(double(circle.q[1]) - std::sin(1.0)), 1e-16);
  for (const double speed : {1.1, 1.5}) {  // an ellipse, a hyperbola
    auto there = Kepler<>{}.exact(at<Kepler<>>({1, 0}, {0.2, speed}), Quad(7));
    const auto back = Kepler<>{}.exact(there, Quad(0));
    EXPECT_LT(std::abs(double(back.q[0] - 1)), 1e-28);
    EXPECT_LT(std::abs(double(back.p[1] - Quad(speed))), 1e-28);
  }
}

TEST(ClosedForm, KeplerWithAnotherMass) {
  const Kepler<> heavy{4};
  Extrapolation<Kepler<>> run(heavy, at<Kepler<>>({1, 0}, {0, 1.5}), 1e-27);
  ASSERT_TRUE(run.advance(Quad(3), [] { return true; }));
  EXPECT_LT(std::abs(double(heavy.exact(at<Kepler<>>({1, 0}, {0, 1.5}), Quad(3)).q[0] - run.state().q[0])), 1e-22);
}

TEST(ClosedForm, PendulumSeparatrixEquilibriaAndTurns) {
  agrees_with_integrator<Pendulum<>>(at<Pendulum<>>({0}, {2}), 10, 1e-20);      // the separatrix
  agrees_with_integrator<Pendulum<>>(at<Pendulum<>>({1}, {-2.5}), 40, 1e-20);   // many turns backwards
  agrees_with_integrator<Pendulum<>>(at<Pendulum<>>({20}, {0.3}), 40, 1e-20);   // libration about another bottom
  const auto top = Pendulum<>{}.exact(at<Pendulum<>>({0}, {2}), Quad(20'000));  // for ever towards the top
  EXPECT_NEAR(static_cast<double>(top.q[0]), std::acos(-1.0), 1e-15);
  EXPECT_LT(std::abs(static_cast<double>(top.p[0])), 1e-15);
  const auto rest = Pendulum<>{}.exact(at<Pendulum<>>({0}, {0}), Quad(5));
  EXPECT_EQ(rest.q[0], Quad(0));
  EXPECT_EQ(rest.p[0], Quad(0));
}

TEST(ClosedForm, OscillatorAfterAQuarterPeriod) {
  const HarmonicOscillator<> m{4, 9};  // ω = 3/2
  State<1, Quad, Quad> x0;
  x0.t = Quad(1);
  x0.q[0] = Quad(2);
  const Quad quarter = parse<Quad>("1.0471975511965977461542144610931676281");
  const auto x = m.exact(x0, x0.t + quarter);
  EXPECT_LT(std::abs(double(x.q[0])), 1e-32);
  EXPECT_LT(std::abs(double(x.p[0] + 12)), 1e-31);  // −q₀ √(km)
}

}  // namespace
