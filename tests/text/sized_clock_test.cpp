// Schemes that choose the length of their steps by the energy, on scenes of many coordinates: energy_momentum.
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

/// Toda's lattice closed to a ring, of which each body is bound to its place where `place` says so; with masses that
/// couple neighbours or without.
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
/// All of them drift.
std::vector<double> start_of(int n) {
  std::vector<double> x;
  for (int i = 0; i < n; ++i) x.push_back(0.5 * std::sin(1 + 2.3 * i * i));
  for (int i = 0; i < n; ++i) x.push_back(0.9 + 0.4 * std::cos(3 * i));
  return x;
}
std::size_t column(const Request& request, std::string_view name) {
  return runs::position(runs::card(request).columns, name, [](const auto& c) { return c.name; });
}
/// What stands in some columns after every step.
std::vector<std::vector<double>> steps_of(Request request, std::initializer_list<std::string_view> columns) {
  request.record = {Record::Mode::every, 1, {}};
  request.columns.clear();
  for (const auto name : columns) request.columns.push_back(column(request, name));
  auto rows = runs::go(request).rows;
  rows.erase(rows.begin());  // where the run begins there is no step yet
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

/// The change of a step and of how long it takes along a direction, by tangents and by differences of runs.
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
    EXPECT_EQ(found.longer != 0, changes_length) << what;
  }
}
TEST(SizedClock, TangentsAreCentralDifferences) {
  for (const int n : {1, 2, 9})
    for (const bool coupled : {false, true}) {
      if (n == 1 && coupled) continue;
      const std::string what = std::to_string(n) + (coupled ? " coupled" : "");
      const auto mechanics = toda(n, coupled, " + q[i]^2/2");
      expect_tangents(stepped("energy_momentum", mechanics, start_of(n), 1, 0.1), "energy_momentum " + what, true);
    }
}

TEST(SizedClock, FitAutonomousScenesAlone) {
  const auto has = [](const std::shared_ptr<const Mechanics>& mechanics, const char* scheme) {
    return runs::fits(mechanics->card(), find_scheme(scheme).value());
  };
  for (const int n : {1, 9, 1024})
    for (const char* scheme : {"energy_momentum"}) {
      EXPECT_TRUE(has(toda(n), scheme)) << n << scheme;
      EXPECT_FALSE(has(toda(n, false, " + q[i]*sin(t)"), scheme)) << n << scheme;
    }
}

}  // namespace
}  // namespace sized_clock
