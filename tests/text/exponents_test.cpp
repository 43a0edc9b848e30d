// lyapunov of scenes typed as text: the same whether they are written with momenta or velocities, and in any units.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/texts.hpp"

namespace {

using namespace texts;

struct Found {
  double exponent, megno;
};
using Start = std::vector<std::pair<std::string, double>>;
Found lyapunov(const Definition& definition, const Start& start, double end) {
  Request request = typed_as(runs::defaults("harmonic_oscillator", "taylor"), mechanics_of(definition));
  for (const auto& [name, value] : start) runs::begin(request, name, value);
  runs::scene(request).start = 0;
  request.end = end;
  request.record.count = 0;
  runs::ask(request, "lyapunov");
  const auto outcome = runs::go(request).outcome;
  EXPECT_EQ(outcome.stop.reason, ReturnCode::completed) << outcome.stop.detail;
  return {runs::number(outcome.diagnostics, "lyapunov/exponent"), runs::number(outcome.diagnostics, "lyapunov/megno")};
}

/// Two planets of these masses about a fixed star, at distances of 1 and 1.7 units of length, with periods of about 2π
/// units of time and 2.2 times as long.
struct Planets {
  double mass, length, time;
  std::vector<std::pair<std::string, double>> parameters() const {
    return {{"m", mass}, {"M", 1e6 * mass}, {"G", length * length * length / (time * time * 1e6 * mass)}};
  }
  Start start() const {
    const double by = length / time * mass;
    return {{"x1", length}, {"y1", 0},          {"x2", 0},           {"y2", 1.7 * length},
            {"px1", 0},     {"py1", 1.05 * by}, {"px2", -0.76 * by}, {"py2", 0.05 * by}};
  }
};
constexpr auto planets_potential =
    "-G*M*m/sqrt(x1^2 + y1^2) - G*M*m/sqrt(x2^2 + y2^2) - G*m*m/sqrt((x1 - x2)^2 + (y1 - y2)^2)";
const std::vector<std::string> places = {"x1", "y1", "x2", "y2"};

// In (x, p) as they are the momenta of light planets are a millionth of their positions.
TEST(Exponents, DependOnNoUnitAndOnNoWayOfSaying) {
  const auto of_planets = [](const Planets& planets) {
    return lyapunov(of(Definition::Kind::hamiltonian, places, planets.parameters(),
                       std::string("(px1^2 + py1^2 + px2^2 + py2^2)/(2*m) + ") + planets_potential),
                    planets.start(), 100 * planets.time);
  };
  const Found here = of_planets({1, 1, 1});
  for (const Planets& planets : {Planets{1e-6, 1, 1}, Planets{6e24, 1.5e11, 5e6}, Planets{3, 1e3, 1e-2}}) {
    const Found there = of_planets(planets);
    EXPECT_NEAR(there.megno, here.megno, 2e-3) << planets.mass;
    EXPECT_NEAR(there.exponent * planets.time, here.exponent, 2e-3 * here.exponent) << planets.mass;
  }
  const Planets planets{1e-6, 1, 1};
  const Found by_velocities =
      lyapunov(of(Definition::Kind::lagrangian, places, planets.parameters(),
                  std::string("m*(vx1^2 + vy1^2 + vx2^2 + vy2^2)/2 - (") + planets_potential + ")"),
               planets.start(), 100);
  EXPECT_NEAR(by_velocities.megno, here.megno, 2e-3);
  EXPECT_NEAR(by_velocities.exponent, here.exponent, 2e-3 * here.exponent);
}

// The mass of a body that does not interact with the others changes no motion.
TEST(Exponents, AreThoseOfVelocitiesWhateverTheMasses) {
  const auto with_mass = [](double m) {
    const std::string orbit = "(px1^2 + py1^2)/2 - 1/sqrt(x1^2 + y1^2)",
                      other = "(px2^2 + py2^2)/(2*m) - m/sqrt(x2^2 + y2^2)";
    Start start = Planets{1, 1, 1}.start();
    for (auto& [name, value] : start)
      if (name == "px2" || name == "py2") value *= m;
    return lyapunov(of(Definition::Kind::hamiltonian, places, {{"m", m}}, orbit + " + " + other), start, 100);
  };
  const Found equal = with_mass(1);
  for (const double m : {0.1, 20.0, 1e-6}) {
    EXPECT_NEAR(with_mass(m).megno, equal.megno, 1e-4) << m;
    EXPECT_NEAR(with_mass(m).exponent, equal.exponent, 1e-5) << m;
  }
}

// A Hamiltonian that has no simpler form and whose momenta are not velocities: a magnetic field that only rotates the
// frame.
TEST(Exponents, OfMomentaThatAreNoVelocitiesAreThoseOfVelocities) {
  const double b = 0.002;
  const auto from = [](double px) { return Start{{"x", 0}, {"y", -4}, {"px", px}, {"py", -0.1}}; };
  const Found turned = lyapunov(of(Definition::Kind::hamiltonian, {"x", "y"}, {{"b", b}},
                                   "((px + b*y)^2 + (py - b*x)^2)/2 - 1/sqrt(x^2 + y^2)"),
                                from(-0.1 + 4 * b), 1000),
              at_rest =
                  lyapunov(of(Definition::Kind::potential, {"x", "y"}, {}, "-1/sqrt(x^2 + y^2)"), from(-0.1), 1000);
  EXPECT_NEAR(at_rest.megno, 1.790, 0.004);
  EXPECT_NEAR(turned.megno, at_rest.megno, 0.1);
}

}  // namespace
