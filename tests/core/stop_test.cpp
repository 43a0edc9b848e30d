// The answer of a run that an event of the caller's own ended: it has nothing beyond that end.
#include <gtest/gtest.h>

#include <cmath>

#include "core/run/measures.hpp"
#include "tests/core/asking.hpp"

namespace {

using namespace least;

/// stopping_at() ends the request's run at the first zero of the expression.
Request stopping_at(const char* expression, Request request) {
  MeasureReader reader(*request.scene);
  const auto fault = reader.read("end", expression);
  if (fault) throw std::invalid_argument(fault->detail);
  request.events.push_back({0, true});
  request.watched = reader.made();
  return request;
}
Request oscillator(std::string_view scheme) {
  Request request = runs::defaults("harmonic_oscillator", scheme);
  request.end = 1;
  return request;
}

TEST(StopAtAnEvent, NoSampleIsLater) {
  for (const char* scheme : {"leapfrog", "runge_kutta_4", "variational_midpoint", "taylor", "dormand_prince_5"}) {
    // Ends within a step, on the grid, in the last step (which overshoots or is cut short), and in the first step.
    for (const double end : {0.52, 0.5, 0.97, 0.999, 0.03}) {
      Request request = oscillator(scheme);
      if (request.scene->mechanics->schemes()[request.scheme].find("step")) runs::set(request, "step", 0.15);
      request = stopping_at(("t-" + std::to_string(end)).c_str(), request);
      request.record = {Record::Mode::samples, 41, {}};
      const auto run = runs::go(request);
      ASSERT_EQ(run.outcome.stop.reason, ReturnCode::completed) << scheme;
      EXPECT_NEAR(run.outcome.t, end, 1e-12) << scheme;
      ASSERT_FALSE(run.rows.empty()) << scheme;
      EXPECT_LE(run.rows.back()[0], run.outcome.t) << scheme;
      EXPECT_EQ(std::ssize(run.rows), static_cast<std::ptrdiff_t>(std::floor(end * 40 + 1e-9)) + 1) << scheme << end;

      // The rows are those of a run that goes on, and recording changes nothing.
      Request on = oscillator(scheme), quiet = request;
      on.settings = request.settings;
      on.record = request.record;
      const auto whole = runs::go(on);
      for (std::size_t i = 0; i < run.rows.size(); ++i)
        for (std::size_t k = 0; k < run.rows[i].size(); ++k)
          EXPECT_NEAR(run.rows[i][k], whole.rows[i][k], 1e-11) << scheme << " " << end << " row " << i;
      runs::only_final(quiet);
      const auto final = runs::go(quiet).outcome;
      EXPECT_EQ(final.t, run.outcome.t) << scheme;
      EXPECT_EQ(final.final, run.outcome.final) << scheme;
    }
  }
}

// An expression that falls to zero exactly where a step ends, and goes on falling, has reached zero.
TEST(StopAtAnEvent, AZeroOnTheGridIsOne) {
  for (const char* scheme : {"leapfrog", "runge_kutta_4", "taylor"})
    for (const char* expression : {"0.5-t", "t-0.5"}) {
      Request request = oscillator(scheme);
      if (request.scene->mechanics->schemes()[request.scheme].find("step")) runs::set(request, "step", 0.125);
      request.record = {Record::Mode::samples, 9, {}};
      const auto run = runs::go(stopping_at(expression, request));
      EXPECT_NEAR(run.outcome.t, 0.5, 1e-15) << scheme << " " << expression;
      EXPECT_EQ(run.rows.size(), 5U) << scheme << " " << expression;
      EXPECT_EQ(run.outcome.events.size(), 1U) << scheme << " " << expression;
    }
}

TEST(StopAtAnEvent, APoleIsNone) {
  for (const char* scheme : {"taylor", "leapfrog", "dormand_prince_5", "bulirsch_stoer"}) {
    Request request = oscillator(scheme);
    request.end = 10;
    const auto run = runs::go(stopping_at("1/q", request));
    EXPECT_EQ(run.outcome.t, 10) << scheme;
    EXPECT_TRUE(run.outcome.events.empty()) << scheme;
  }
}

}  // namespace
