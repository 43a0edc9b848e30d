// record.curve: samples at equal distances along the curve in the space of the columns asked for.
#include "core/run/curve.hpp"

#include <cmath>

#include "tests/core/asking.hpp"

namespace {

using namespace least;
using namespace asks;
using Rows = std::vector<std::vector<double>>;

Request drawing(std::string_view problem, std::string_view scheme, std::int64_t count,
                std::initializer_list<std::string_view> names) {
  Request request = runs::defaults(problem, scheme);
  request.record = {Record::Mode::curve, count, {}};
  request.columns.clear();
  for (const auto name : names)
    request.columns.push_back(
        runs::position(runs::card(request).columns, name, [](const auto& column) { return column.name; }));
  return request;
}
/// distances() returns the longest and the shortest distance between neighbours, in units of the mean.
std::pair<double, double> distances(const Rows& rows, std::size_t first = 1) {
  double least = 1e300, most = 0, sum = 0;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    double square = 0;
    for (std::size_t k = first; k < rows[i].size(); ++k) square += std::pow(rows[i][k] - rows[i - 1][k], 2);
    least = std::min(least, std::sqrt(square));
    most = std::max(most, std::sqrt(square));
    sum += std::sqrt(square);
  }
  const double mean = sum / double(rows.size() - 1);
  return {most / mean, least / mean};
}

// An ellipse of eccentricity .9: at equal times neighbours lie 19 times farther apart at the periapsis than at the
// apoapsis. Short steps, long ones, and steps that adapt.
TEST(Curve, IsEvenWhateverTheSteps) {
  struct Case {
    const char *scheme, *setting;
    double value;
  };
  for (const auto& [scheme, setting, value] : {Case{"leapfrog", "step", 1e-4},
                                               {"runge_kutta_4", "step", 0.01},
                                               {"dormand_prince_5", "tolerance", 1e-9},
                                               {"bulirsch_stoer", "tolerance", 1e-9},
                                               {"taylor", "tolerance", 1e-9},
                                               {"time_transformed", "sigma", 0.05},
                                               {"jacobi_maupertuis", "step", 1e-3}}) {
    Request request = drawing("kepler", scheme, 400, {"t", "x", "y"});
    runs::set(request, setting, value);
    runs::scene(request).initial = {0.1, 0, 0, std::sqrt(19.0)};
    request.end = runs::scene(request).start + 6.2;
    const auto result = runs::go(request);
    ASSERT_EQ(result.outcome.stop.reason, ReturnCode::completed) << scheme;
    ASSERT_EQ(result.rows.size(), 400U) << scheme;
    EXPECT_EQ(result.rows.front()[1], 0.1);
    EXPECT_EQ(result.rows.back()[0], request.end);
    EXPECT_EQ(result.rows.back()[1], result.outcome.final[0]) << scheme;
    const auto [most, least] = distances(result.rows);
    EXPECT_LT(most, 1.15) << scheme;
    EXPECT_GT(least, 0.85) << scheme;
  }
}

// The samples lie on the orbit, not on chords between steps.
TEST(Curve, IsMadeOfStatesOfTheMotion) {
  Request request = drawing("harmonic_oscillator", "dormand_prince_5", 300, {"q", "p", "energy", "error"});
  runs::set(request, "tolerance", 1e-10);
  const auto rows = runs::go(request).rows;
  for (const auto& row : rows) {
    EXPECT_NEAR(row[2], rows[0][2], 1e-7);
    EXPECT_LT(row[3], 1e-6);
  }
}

TEST(Curve, OfOneStepHasAllItsSamples) {
  Request request = drawing("pendulum", "leapfrog", 1000, {"t", "q", "p"});
  runs::set(request, "step", 0.5);
  for (const double end : {0.5, 0.2}) {  // a whole step, and a shorter one
    request.end = runs::scene(request).start + end;
    const auto rows = runs::go(request).rows;
    ASSERT_EQ(rows.size(), 1000U);
    for (std::size_t i = 1; i < rows.size(); ++i) EXPECT_GT(rows[i][0], rows[i - 1][0]);
    EXPECT_EQ(rows.back()[0], request.end);
  }
}

// The time is not a coordinate of the space, unless there is no other column.
TEST(Curve, OfWhatDoesNotMoveIsThereToo) {
  Request request = drawing("pendulum", "leapfrog", 50, {"t", "q"});
  runs::begin(request, "q", 0);
  runs::begin(request, "p", 0);
  EXPECT_EQ(runs::go(request).rows.size(), 50U);
  const auto times = runs::go(drawing("pendulum", "leapfrog", 50, {"t"})).rows;
  ASSERT_EQ(times.size(), 50U);
  const auto [most, least] = distances(times, 0);
  EXPECT_LT(most, 1.15);
  EXPECT_GT(least, 0.85);
}

TEST(Curve, BeginsOnASeriesAndEndsWithTheDomain) {
  Request request = drawing("lane_emden", "contact_leapfrog", 200, {"t", "q", "p"});
  runs::set(request, "n", 1);
  runs::set(request, "after_zero", "stop");
  runs::set(request, "step", 0.05);
  request.end = 10;
  const auto result = runs::go(request);
  EXPECT_EQ(result.outcome.stop.reason, ReturnCode::left_domain) << result.outcome.stop.detail;
  ASSERT_EQ(result.rows.size(), 200U);
  EXPECT_NEAR(result.rows.back()[0], std::acos(-1.0), 2e-3);
  for (const auto& row : result.rows) {
    EXPECT_GE(row[1], -1e-12);
    EXPECT_NEAR(row[1], row[0] > 0 ? std::sin(row[0]) / row[0] : 1, 1e-3) << row[0];
  }
  const auto [most, least] = distances(result.rows);
  EXPECT_LT(most, 1.2);
  EXPECT_GT(least, 0.8);
}

// The first step of explicit Euler moves only p.
TEST(Curve, BeginsAtTheStartThoughItRestsThere) {
  Request request = drawing("harmonic_oscillator", "explicit_euler", 50, {"t", "q"});
  runs::begin(request, "q", 1);
  runs::begin(request, "p", 0);
  const auto rows = runs::go(request).rows;
  ASSERT_EQ(rows.size(), 50U);
  EXPECT_EQ(rows.front()[0], 0);
  EXPECT_EQ(rows.back()[0], request.end);
}

// Both ends of a step of several radians may lie at the same q, with a whole swing in between.
TEST(Curve, SeesSwingsWithinLongSteps) {
  Request request = drawing("harmonic_oscillator", "taylor", 2000, {"t", "q"});
  request.end = 1000;
  const auto result = runs::go(request);
  EXPECT_LT(result.outcome.cost.steps, 700);
  ASSERT_EQ(result.rows.size(), 2000U);
  double least = 1, most = 1;  // of |q| at its turning points, among the samples
  for (std::size_t i = 1; i + 1 < result.rows.size(); ++i) {
    const double before = result.rows[i - 1][1], q = result.rows[i][1], after = result.rows[i + 1][1];
    if ((q - before) * (after - q) < 0) least = std::min(least, std::abs(q));
    most = std::max(most, std::abs(q));
  }
  EXPECT_NEAR(most, 1, 1e-9);
  EXPECT_GT(least, 0.5) << "three or so samples a swing cannot miss it by more";
}

TEST(Run, ThatStopsInAStepBeyondItsEndStopsBefore) {
  Request request = runs::defaults("harmonic_oscillator", "taylor");
  request.end = 1;
  request.record = {Record::Mode::samples, 100'000, {}};
  request.limits.seconds = 0.01;
  const runs::TurnedClock clock(1e-3);
  const auto result = runs::go(request);
  EXPECT_EQ(result.outcome.stop.reason, ReturnCode::deadline);
  EXPECT_LE(result.outcome.stop.t, 1);
  EXPECT_LE(result.outcome.t, 1);
}

// However long the run, a bounded number of rows is held, and the beginning is not sampled more densely than the end.
TEST(Curve, OfALongRunIsEven) {
  Request request = drawing("kepler", "leapfrog", 100, {"t", "x", "y"});
  request.end = runs::scene(request).start + 2000;
  const auto rows = runs::go(request).rows;
  ASSERT_EQ(rows.size(), 100U);
  EXPECT_NEAR(rows[50][0] - rows[0][0], 1000, 60);
}

// If the length of a run of ten thousand steps is known, it is not sampled more densely at first than the rows that are
// kept in the end need.
TEST(CurveThinner, LooksNoCloserThanTheWholeNeeds) {
  CurveThinner known(100), unknown_end(100);
  const auto rows = [](CurveThinner& thinner, bool told) {
    std::size_t seen = 0;
    for (int step = 1; step <= 10000; ++step)
      for (std::size_t k = 0, parts = thinner.parts(1, told ? step / 1e4 : unknown); k < parts; ++k, ++seen) {
        thinner.add(1 / double(parts));
        if (thinner.full()) thinner.thin();
      }
    EXPECT_EQ(thinner.choose().size(), 100U);
    return seen;
  };
  EXPECT_LE(rows(known, true), 15000U);
  EXPECT_GE(rows(unknown_end, false), 30000U);
  // A run that ends early has enough rows all the same.
  CurveThinner early(100);
  for (std::size_t k = 0, parts = early.parts(1, 1e-6); k < parts; ++k) early.add(1 / double(parts));
  EXPECT_EQ(early.choose().size(), 100U);
}

TEST(CurveThinner, HoldsNoMoreThanItSays) {
  CurveThinner thinner(10);
  std::size_t rows = 0, most = 0;
  for (int i = 0; i < 100000; ++i) {
    if (!thinner.add(i == 0 ? 0 : 1 + i % 7)) ++rows;
    most = std::max(most, rows);
    if (thinner.full()) rows = thinner.thin().size();
  }
  EXPECT_LE(most, 320U);
  EXPECT_GE(rows, 150U);
  EXPECT_EQ(thinner.choose().size(), 10U);
}

}  // namespace
