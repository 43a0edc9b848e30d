// Schemes that choose the length of their steps by the energy, on scenes of many coordinates: energy_momentum and
// jacobi_maupertuis.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "core/catalogue/catalogue.hpp"
#include "core/run/backend.hpp"
#include "tests/support/sized.hpp"

namespace sized_clock {
namespace {

using namespace sized;
constexpr auto typed_v = Definition::Kind::potential, typed_l = Definition::Kind::lagrangian;

/// Toda's lattice closed to a ring, with an additional potential `place` of each body; with a kinetic matrix that
/// couples neighbours or without.
std::shared_ptr<const Mechanics> toda(int n, bool coupled = false, const char* place = "") {
  text::TypedScene typed;
  const std::string potential = "sum(i=1..n, exp(q[i] - q[mod(i,n)+1])" + std::string(place) + ")";
  typed.scene = of(typed_v, {"q[n]"}, {{"n", double(n)}}, potential);
  if (coupled) {
    typed.scene.kind = typed_l;
    typed.scene.formula = "sum(i=1..n, v[i]^2/2) + sum(i=1..n-1, v[i]*v[i+1])/3 - " + potential;
  } else {
    typed.scene.masses = {{"q[i]", "1 + i/n"}};
  }
  return made(typed);
}
/// start_of() returns a start at which all bodies drift.
std::vector<double> start_of(int n) {
  std::vector<double> x;
  for (int i = 0; i < n; ++i) x.push_back(0.5 * std::sin(1 + 2.3 * i * i));
  for (int i = 0; i < n; ++i) x.push_back(0.9 + 0.4 * std::cos(3 * i));
  return x;
}
std::size_t column(const Request& request, std::string_view name) {
  return runs::position(runs::card(request).columns, name, [](const auto& c) { return c.name; });
}
/// steps_of() returns the values of some columns after every step.
std::vector<std::vector<double>> steps_of(Request request, std::initializer_list<std::string_view> columns) {
  request.record = {Record::Mode::every, 1, {}};
  request.columns.clear();
  for (const auto name : columns) request.columns.push_back(column(request, name));
  auto rows = runs::go(request).rows;
  rows.erase(rows.begin());  // the row of the start belongs to no step
  return rows;
}

TEST(SizedEnergyMomentum, HasOrderTwo) {
  for (const bool coupled : {false, true}) {
    const auto mechanics = toda(24, coupled);
    const auto truth = final_of(request_by("taylor", mechanics, start_of(24), 4));
    const auto error = [&](double step) {
      return distance(final_of(stepped("energy_momentum", mechanics, start_of(24), 4, step)), truth);
    };
    const double coarse = error(0.1), fine = error(0.05);
    EXPECT_NEAR(std::log2(coarse / fine), 2, 0.15) << coupled;
    EXPECT_GT(fine, 1e-7) << coupled;
  }
}

// A constant in V changes neither the motion nor the lengths of steps, which depend on differences of V.
TEST(SizedEnergyMomentum, DoesNotFeelAConstant) {
  for (const char* rest : {"x^2/2 + x^4/4", "x^2/2 + (y - x)^4/4 + y^2"}) {
    const bool two = std::string_view(rest).find('y') != std::string_view::npos;
    const auto final = [&](const std::string& text) {
      const auto variables = two ? std::vector<std::string>{"x", "y"} : std::vector<std::string>{"x"};
      const auto start = two ? std::vector{1.0, 0.3, 0.2, 0.7} : std::vector{1.0, 0.2};
      return final_of(stepped("energy_momentum", mechanics_of(of(Definition::Kind::potential, variables, {}, text)),
                              start, 20, 0.02));
    };
    const auto plain = final(rest);
    for (const char* constant : {" + 1e5", " - 3e4 - 7e4"})
      EXPECT_LT(distance(final(rest + std::string(constant)), plain), 1e-12) << rest << constant;
    EXPECT_LT(distance(final("1e5 - (" + std::string("-1)*(") + rest + ")"), plain), 1e-12) << rest;
  }
}

TEST(SizedEnergyMomentum, KeepsDiscreteEnergyAndMomenta) {
  for (const int n : {9, 50})
    for (const bool coupled : {false, true}) {
      const Request request = stepped("energy_momentum", toda(n, coupled), start_of(n), 40, 0.1);
      double low = 1e300, high = -1e300, shortest = 1, longest = 0, most = 0, least = 1e300;
      const auto rows = steps_of(request, {"discrete_energy", "step_size", "energy"});
      EXPECT_NEAR(rows[0][1], 0.1, 1e-10) << "the level is that of a first step of the nominal length";
      for (const auto& row : rows) {
        low = std::min(low, row[0]), high = std::max(high, row[0]);
        shortest = std::min(shortest, row[1]), longest = std::max(longest, row[1]);
        least = std::min(least, row[2]), most = std::max(most, row[2]);
      }
      EXPECT_LT((high - low) / high, 1e-13) << n << coupled;
      EXPECT_GT((most - least) / most, 1e-6) << n << coupled << ": the energy itself is off by O(h²)";
      EXPECT_GT(longest, 1.001 * shortest) << n << coupled;
      double before = 0, after = 0;
      const auto last = final_of(request), start = start_of(n);
      for (std::size_t i = std::size_t(n); i < 2 * std::size_t(n); ++i) before += start[i], after += last[i];
      EXPECT_NEAR(before, after, 1e-11) << n << coupled;
    }
}

/// Kepler's motion of x and y beside `others` coordinates bound to 0, which change nothing while they rest.
std::shared_ptr<const Mechanics> orbit(int others, bool coupled = false, const char* more = "") {
  text::TypedScene typed;
  const std::string potential = "-mu/sqrt(x^2 + y^2) + sum(i=1..n, z[i]^2/2 + z[i]^4/4)";
  typed.scene = of(typed_v, {"x", "y", "z[n]"}, {{"mu", 1}, {"n", double(others)}}, potential);
  if (coupled) {
    typed.scene.kind = typed_l;
    typed.scene.formula = std::string("(vx^2 + vy^2)/2 + sum(i=1..n, vz[i]^2/2) + sum(i=1..n-1, vz[i]*vz[i+1])/3") +
                          more + " - (" + potential + ")";
  }
  return made(typed);
}
/// apoapsis() starts at the apoapsis of an eccentric ellipse, with each other coordinate and momentum at `each`.
std::vector<double> apoapsis(int others, double each = 0) {
  const auto n = static_cast<std::size_t>(others);
  std::vector<double> x(2 * (n + 2), each);
  x[0] = 1.8, x[1] = 0, x[n + 2] = 0, x[n + 3] = std::sqrt(0.2 / 1.8);
  std::fill(x.begin() + static_cast<std::ptrdiff_t>(n) + 4, x.end(), 0.0);
  return x;
}
Request passages(const std::shared_ptr<const Mechanics>& mechanics, const std::vector<double>& start, double end,
                 double theta) {
  Request request = stepped("jacobi_maupertuis", mechanics, start, end, 4 * theta);
  runs::set(request, "theta", theta);
  runs::set(request, "critical_kinetic_energy", 1);
  return request;
}

struct Way {
  const char* quadrature;
  int order;
  bool root, paper;
};
constexpr Way ways[] = {{"trapezoid", 4, true, false}, {"trapezoid", 2, false, true}, {"trapezoid", 2, false, false},
                        {"trapezoid", 6, true, false}, {"midpoint", 4, true, false},  {"midpoint", 2, false, true},
                        {"midpoint", 2, true, false}};
void choose(Request& request, const Way& way) {
  runs::set(request, "quadrature", way.quadrature);
  runs::set(request, "order", way.order);
  runs::set(request, "energy_root", way.root ? 1 : 0);
  runs::set(request, "exit", way.paper ? "paper" : "nominal");
}

TEST(SizedJacobiMaupertuis, PassesThePeriapsisAsTheCompiledProblem) {
  Request compiled = runs::defaults("kepler", "jacobi_maupertuis");
  const auto four = apoapsis(0);
  std::ranges::copy(four, runs::scene(compiled).initial.begin());
  for (const int others : {7, 48})
    for (const bool coupled : {false, true})
      for (const Way& way : ways) {
        Request typed = passages(orbit(others, coupled), apoapsis(others), 20, 0.01);
        // How often θ is halved depends on the number of coordinates.
        runs::set(typed, "alpha_max", std::nan(""));
        choose(typed, way);
        compiled.settings = typed.settings;
        compiled.end = typed.end;
        const auto expected = steps_of(compiled, {"t", "x", "y", "px", "py", "mode", "parameter", "discrete_energy"}),
                   found = steps_of(typed, {"t", "x", "y", "px", "py", "mode", "parameter", "discrete_energy"});
        ASSERT_EQ(found.size(), expected.size()) << others << coupled << way.quadrature << way.order;
        double off = 0;
        int fast = 0;
        for (std::size_t i = 0; i < found.size(); ++i) {
          for (std::size_t k = 0; k < 8; ++k)
            if (!std::isnan(expected[i][k]) || !std::isnan(found[i][k]))
              off = std::max(off, std::isfinite(found[i][k]) ? std::abs(found[i][k] - expected[i][k]) : 1e300);
          fast += found[i][5] > 0;
        }
        // The secant method of the published exit ends when h has half of its digits.
        EXPECT_LT(off, way.paper ? 1e-6 : 1e-8) << others << coupled << way.quadrature << way.order << way.paper;
        EXPECT_GT(fast, 100) << others << coupled << way.quadrature << way.order;
      }
}

// Coordinates twice as long with a quarter of the mass, stepped twice as far: by the metric they are the same.
TEST(SizedJacobiMaupertuis, MeasuresLengthsByTheMetric) {
  text::TypedScene typed;
  typed.scene = of(typed_v, {"x", "y"}, {{"mu", 1}}, "-2*mu/sqrt(x^2 + y^2)");
  typed.scene.masses = {{"x", "1/4"}, {"y", "1/4"}};
  const auto four = apoapsis(0);
  Request wide = passages(made(typed), {2 * four[0], 0, 0, four[3] / 2}, 20, 0.01);
  runs::set(wide, "theta", 0.02);
  runs::set(wide, "alpha_max", 0.02);
  Request compiled = runs::defaults("kepler", "jacobi_maupertuis");
  std::ranges::copy(four, runs::scene(compiled).initial.begin());
  compiled.settings = wide.settings;
  runs::set(compiled, "theta", 0.01);
  compiled.end = wide.end;
  const auto expected = steps_of(compiled, {"t", "x", "y", "parameter"}),
             found = steps_of(wide, {"t", "x", "y", "parameter"});
  ASSERT_EQ(found.size(), expected.size());
  double shortest = 1;
  for (std::size_t i = 1; i < found.size(); ++i) {
    EXPECT_NEAR(found[i][0], expected[i][0], 1e-9) << i;
    EXPECT_NEAR(found[i][1], 2 * expected[i][1], 1e-8) << i;
    EXPECT_NEAR(found[i][2], 2 * expected[i][2], 1e-8) << i;
    EXPECT_TRUE(found[i][3] == expected[i][3] || std::isnan(expected[i][3])) << i;
    if (!std::isnan(found[i][3]))
      shortest = std::min(shortest, std::hypot(found[i][1] - found[i - 1][1], found[i][2] - found[i - 1][2]));
  }
  EXPECT_LT(shortest, 0.015) << "nowhere did the turn of the orbit halve a step";
}

TEST(SizedJacobiMaupertuis, HasItsOrdersWithOthersThatMove) {
  for (const auto& [others, coupled] : {std::pair{7, false}, std::pair{48, true}}) {
    const auto mechanics = orbit(others, coupled, " + vx*vz[1]/5 + vy*vz[2]/5");
    const auto start = apoapsis(others, 0.3);
    const auto truth = final_of(request_by("taylor", mechanics, start, 7));
    for (const int order : {2, 4, 6}) {
      const auto error = [&](double theta) {
        Request request = passages(mechanics, start, 7, theta);
        runs::set(request, "order", order);
        return distance(final_of(request), truth);
      };
      const double coarse = error(0.02), fine = error(0.01);
      EXPECT_GT(std::log2(coarse / fine), order - 0.3) << others << coupled;
      EXPECT_GT(fine, 1e-10) << others << coupled << order;
    }
  }
}

/// expect_tangents() compares the derivatives of a step and of its duration along a direction by tangents and by
/// differences of runs.
void expect_tangents(const Request& given, const std::string& what, bool changes_length) {
  Request request = given;
  request.until_steps = true;
  request.steps = 1;
  request.columns = {column(request, "t")};
  const std::vector<double> start = request.scene->initial;
  const std::size_t size = start.size();
  const auto backend = request.scene->mechanics->backend(request);
  const auto tangents = backend->tangents(request);
  ASSERT_TRUE(tangents.along && tangents.plain) << what;
  ASSERT_EQ(tangents.level.size(), size) << what;
  const auto step_from = [&](const std::vector<double>& x) {
    Request one = request;
    runs::scene(one).initial = x;
    one.record = {Record::Mode::every, 1, {}};
    const auto ran = runs::go(one);
    auto numbers = ran.outcome.final;
    numbers.push_back(ran.rows.back()[0]);
    return numbers;
  };
  for (const double turn : {0.3, 1.7}) {
    StateNumbers u(size);
    for (std::size_t i = 0; i < size; ++i) u[i] = std::cos(turn * double(i * i + 1));
    double level = 0;
    for (std::size_t i = 0; i < size; ++i) level += tangents.level[i] * u[i];
    ChangeOfStep found;
    ASSERT_TRUE(
        tangents.along({request.scene->start, StateNumbers(start.data(), start.data() + size)}, {}, u, 0, level, found))
        << what;
    std::vector<double> slopes(size + 1);
    constexpr double aside = 1e-4;
    for (const auto& [far, weight] : {std::pair{1, 8.0}, std::pair{2, -1.0}})
      for (const int side : {-1, 1}) {
        auto x = start;
        for (std::size_t i = 0; i < size; ++i) x[i] += side * far * aside * u[i];
        const auto end = step_from(x);
        for (std::size_t i = 0; i <= size; ++i) slopes[i] += side * weight * end[i] / (12 * aside);
      }
    for (std::size_t i = 0; i < size; ++i) EXPECT_NEAR(found.change[i], slopes[i], 2e-8) << what << " " << i;
    EXPECT_NEAR(found.longer, slopes[size], 2e-8) << what;
    if (!changes_length) {
      EXPECT_EQ(found.longer, 0) << what;
    }
    // Whether the first step keeps its length depends on the level of the run: with the level held fixed it changes.
    ChangeOfStep held;
    ASSERT_TRUE(
        tangents.along({request.scene->start, StateNumbers(start.data(), start.data() + size)}, {}, u, 0, 0, held));
    EXPECT_EQ(std::abs(held.longer) > 1e-6, changes_length) << what << " " << held.longer;
  }
}
TEST(SizedClock, TangentsAreCentralDifferences) {
  for (const int n : {1, 2, 9})
    for (const bool coupled : {false, true}) {
      if (n == 1 && coupled) continue;
      const std::string what = std::to_string(n) + (coupled ? " coupled" : "");
      const auto mechanics = toda(n, coupled, " + q[i]^2/2");
      expect_tangents(stepped("energy_momentum", mechanics, start_of(n), 1, 0.1), "energy_momentum " + what, true);
      for (const Way& way : ways)
        for (const double critical : {0.0, 1e3}) {
          if (way.paper && critical > 0) continue;
          Request request = stepped("jacobi_maupertuis", mechanics, start_of(n), 1, 0.1);
          runs::set(request, "theta", 0.1);
          runs::set(request, "critical_kinetic_energy", critical);
          choose(request, way);
          expect_tangents(request,
                          std::string("jacobi_maupertuis ") + way.quadrature + std::to_string(way.order) + " " +
                              std::to_string(critical) + " " + what,
                          critical == 0);
        }
    }
}

// In a well narrower than a step along any coordinate steps are in time, and their lengths change.
TEST(SizedClock, TangentsOfStepsThatCannotBeTakenAlongACoordinate) {
  for (const char* quadrature : {"trapezoid", "midpoint"}) {
    Request request = stepped("jacobi_maupertuis", toda(9, false, " + 50*q[i]^2"), std::vector<double>(18, 0.1), 1, 1);
    for (std::size_t i = 9; i < 18; ++i) runs::scene(request).initial[i] = 0.9 + 0.01 * double(i);
    runs::set(request, "theta", 2);
    runs::set(request, "critical_kinetic_energy", 0);
    runs::set(request, "alpha_max", std::nan(""));
    runs::set(request, "order", 2);
    runs::set(request, "quadrature", quadrature);
    expect_tangents(request, quadrature, true);
    request.record = {Record::Mode::every, 1, {}};
    request.columns = {column(request, "parameter")};
    EXPECT_TRUE(std::isnan(runs::go(request).rows.back()[0])) << quadrature;
  }
}

TEST(SizedClock, FitAutonomousScenesAlone) {
  const auto has = [](const std::shared_ptr<const Mechanics>& mechanics, const char* scheme) {
    return runs::fits(mechanics->card(), find_scheme(scheme).value());
  };
  for (const int n : {1, 9, 1024})
    for (const char* scheme : {"energy_momentum", "jacobi_maupertuis"}) {
      EXPECT_TRUE(has(toda(n), scheme)) << n << scheme;
      EXPECT_FALSE(has(toda(n, false, " + q[i]*sin(t)"), scheme)) << n << scheme;
    }
}

}  // namespace
}  // namespace sized_clock
