// Grids, schedules and budgets: where a run steps, where it samples, where it ends.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <thread>

#include "core/run/save_schedule.hpp"
#include "tests/support/runs.hpp"

namespace {

using namespace least;

Request span(double start, double end) {
  Request request;
  const auto scene = std::make_shared<Scene>();
  scene->start = start;
  request.scene = scene;
  request.end = end;
  return request;
}
Grid grid(double start, double end, double h) { return Grid(span(start, end), h); }

TEST(Grid, HasWholeStepsAndOneShorterOne) {
  EXPECT_EQ(grid(0, 20, 0.1).steps, 200);  // the double 0.1 is not a tenth, and 200 · 0.1 is 20 all the same
  EXPECT_EQ(grid(0, 20, 0.1).tail, 0);
  EXPECT_EQ(grid(0, 40, 0.01).steps, 4000);
  EXPECT_EQ(grid(0, 40, 0.01).tail, 0);
  EXPECT_EQ(grid(0, 1, 0.3).steps, 3);
  EXPECT_NEAR(grid(0, 1, 0.3).tail, 0.1, 1e-15);
  EXPECT_EQ(grid(0, 0.1, 1).steps, 0);
  EXPECT_EQ(grid(0, 0.1, 1).tail, 0.1);
  EXPECT_EQ(grid(5, 6, 0.25).steps, 4);
  EXPECT_EQ(grid(5, 6, 0.25).time(4), 6);
  EXPECT_EQ(grid(0, 0.3, 0.1).steps, 3);  // 0.3/0.1 is a little less than 3
  for (int n = 1; n < 3000; ++n) {
    const double h = 0.01;
    EXPECT_EQ(grid(0, n * h, h).steps, n);
    EXPECT_EQ(grid(0, n * h, h).tail, 0) << n;
  }
}

TEST(Grid, KnowsTheStepBeforeATime) {
  for (const auto& [start, end, h] : {std::array{0.0, 20.0, 0.1}, {2.5, 3.3, 0.01}, {1e6, 1e6 + 0.7, 1e-4}}) {
    const Grid g = grid(start, end, h);
    for (int k = 0; k <= 1000; ++k) {
      const double t = start + (end - start) * k / 1000;
      const std::int64_t n = g.step_before(t);
      EXPECT_LE(g.time(n), t);
      EXPECT_TRUE(n == g.steps || g.time(n + 1) > t) << t;
    }
    EXPECT_EQ(g.step_before(std::numeric_limits<double>::infinity()), g.steps);
  }
}

std::vector<double> times(const Record& record, const Grid& g) {
  Request request = span(g.start, g.end);
  request.record = record;
  std::vector<double> all;
  for (SaveSchedule schedule(request, g.end); all.size() < 1000; schedule.next()) {
    if (schedule.step() <= g.steps) {
      all.push_back(g.time(schedule.step()));
    } else if (std::isfinite(schedule.time())) {
      all.push_back(schedule.time());
    } else {
      break;
    }
  }
  return all;
}

TEST(SaveSchedule, ByStrideByNumberAndByTime) {
  const Grid g = grid(1, 2, 0.3);  // 1, 1.3, 1.6, 1.9 and the end
  EXPECT_EQ(times({Record::Mode::every, 2, {}}, g), (std::vector<double>{1, 1.6}));
  EXPECT_TRUE(times({Record::Mode::every, 0, {}}, g).empty());
  EXPECT_EQ(times({Record::Mode::samples, 3, {}}, g), (std::vector<double>{1, 1.5, 2}));
  const std::vector<double> asked{1, 1.3, 1.45, 1.95, 2};
  EXPECT_EQ(times({Record::Mode::times, 0, asked}, g), asked);
}

// Where n·h rounds to more or less than the end, the run ends at the time asked for, and a sample there is the final
// state.
TEST(Run, EndsWhereItWasToldTo) {
  for (const auto& [h, end] : {std::pair{0.1, 0.3}, {0.1, 0.7}, {0.01, 0.29}, {0.25, 1.0000000000000002}, {0.3, 1.0}}) {
    for (const double start : {0.0, 2.5}) {
      Request request = runs::defaults("harmonic_oscillator", "leapfrog");
      request.settings[0] = h;
      runs::scene(request).start = start;
      request.end = start + end;
      for (const auto& record : {Record{Record::Mode::samples, 3, {}}, Record{Record::Mode::times, 0, {request.end}}}) {
        request.record = record;
        const auto result = runs::go(request);
        EXPECT_EQ(result.outcome.t, request.end) << h;
        ASSERT_FALSE(result.rows.empty());
        EXPECT_EQ(result.rows.back(),
                  (std::vector<double>{request.end, result.outcome.final[0], result.outcome.final[1]}));
      }
    }
  }
}

TEST(SaveSchedule, EndsWhereTheClockCannotResolveTheStep) {
  const Grid g = grid(1e300, 1.5e300, 0.01);
  EXPECT_EQ(times({Record::Mode::samples, 5, {}}, g).size(), 5U);
  const Grid h = grid(1e17, 1e17 + 64, 0.01);
  const auto got = times({Record::Mode::samples, 5, {}}, h);
  EXPECT_EQ(got.front(), 1e17);
  EXPECT_EQ(got.back(), 1e17 + 64);
}

// ---- the loop

TEST(Run, StandsOnTheGrid) {
  Request request = runs::defaults("kepler", "leapfrog");
  runs::scene(request).start = 3;
  request.end = 4.005;
  const auto result = runs::go(request);
  ASSERT_EQ(result.rows.size(), 101U);  // the end of the shorter last step is not a grid point
  for (std::size_t n = 0; n < result.rows.size(); ++n) EXPECT_EQ(result.rows[n][0], 3 + double(n) * 0.01);
  EXPECT_EQ(result.outcome.t, 4.005);
  EXPECT_EQ(result.outcome.cost.steps, 101);
}

TEST(Run, SamplesBetweenGridPointsAreAsAccurateAsTheScheme) {
  Request request = runs::defaults("harmonic_oscillator", "leapfrog");
  request.settings = {0.5, 6};  // suzuki_umeno_8
  request.record = {Record::Mode::samples, 137, {}};
  const auto result = runs::go(request);
  ASSERT_EQ(result.rows.size(), 137U);
  for (const auto& row : result.rows) {
    EXPECT_NEAR(row[1], std::cos(row[0]), 1e-5);
    EXPECT_NEAR(row[2], -std::sin(row[0]), 1e-5);
  }
}

TEST(Budget, StepsSecondsCancellationAndTheReceiver) {
  Request request = runs::defaults("kepler", "leapfrog");
  request.limits.steps = 1234;
  auto result = runs::go(request);
  EXPECT_EQ(result.outcome.stop.reason, ReturnCode::step_limit);
  EXPECT_EQ(result.outcome.stop.step, 1234);
  EXPECT_EQ(result.rows.size(), 1235U);
  request.limits.steps = 4000;  // exactly enough
  EXPECT_EQ(runs::go(request).outcome.stop.reason, ReturnCode::completed);

  request.limits.steps = std::int64_t{1} << 60;
  request.until_steps = true;
  request.steps = std::int64_t{1} << 50;
  request.record.count = std::int64_t{1} << 49;
  {
    const runs::TurnedClock clock(1e-3);  // steps so slow that blocks have the shortest length
    request.limits.seconds = 0.1;
    result = runs::go(request);
    EXPECT_EQ(result.outcome.stop.reason, ReturnCode::deadline);
    EXPECT_LE(result.outcome.cost.seconds, 0.104);
    EXPECT_NEAR(double(result.outcome.stop.step), 1600, 50);
  }
  {
    const runs::TurnedClock fast(1e-5);  // blocks become longer
    request.limits.seconds = 3e-4;
    result = runs::go(request);
    EXPECT_EQ(result.outcome.stop.reason, ReturnCode::deadline);
    EXPECT_GT(result.outcome.stop.step, 1'000'000);
    EXPECT_LT(fast.looks(), 50);
  }

  request.limits.seconds = 60;
  std::atomic<bool> cancelled{false};
  std::thread later([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    cancelled = true;
  });
  Samples samples;
  EXPECT_EQ(request.scene->mechanics->run(request, samples, cancelled).stop.reason, ReturnCode::cancelled);
  later.join();

  struct Full final : RowSink {
    bool append(std::span<const double>) override { return false; }
  } full;
  request.record.count = 1;
  cancelled = false;
  EXPECT_EQ(request.scene->mechanics->run(request, full, cancelled).stop.reason, ReturnCode::cancelled);
}

TEST(Budget, DeadlineHoldsBetweenGridPoints) {
  Request request = runs::defaults("double_pendulum", "galerkin_4");
  request.settings = {0.1, 8};
  request.end = 0.1;
  request.record = {Record::Mode::samples, 1'000'000, {}};
  request.limits.seconds = 0.05;
  const runs::TurnedClock clock(1e-3);
  const auto result = runs::go(request);
  EXPECT_EQ(result.outcome.stop.reason, ReturnCode::deadline);
  EXPECT_LE(result.outcome.cost.seconds, 0.054);
}

TEST(Budget, DeadlineHoldsForSlowSteps) {
  Request request = runs::defaults("double_pendulum", "galerkin_4");
  request.settings = {1e-6, 8};  // 35 implicit stages a step
  request.limits.seconds = 0.05;
  const runs::TurnedClock clock(1e-3);
  const auto result = runs::go(request);
  EXPECT_EQ(result.outcome.stop.reason, ReturnCode::deadline);
  EXPECT_LE(result.outcome.cost.seconds, 0.054);
}

}  // namespace
