// Equations of motion that are singular on the way.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/texts.hpp"

namespace {

using namespace texts;

// x = √(1 − 2t) ends at t = 1/2. Steps of equal length hardly ever meet the one point where its rate is undefined.
TEST(SingularMotion, IsWarnedOfWhereARunGoesOnBeyond) {
  const auto mechanics = mechanics_of(flow({"x"}, {}, {{"x", "-1/x"}}));
  for (const char* scheme : {"explicit_euler", "explicit_midpoint", "runge_kutta_4"})
    for (const double end : {0.4, 1.0}) {
      Request request = typed_as(runs::defaults("kepler", scheme), mechanics);
      runs::scene(request).initial = {1};
      request.end = end;
      request.control = true;
      runs::only_final(request);
      const auto outcome = runs::go(request).outcome;
      ASSERT_EQ(outcome.stop.reason, ReturnCode::completed) << scheme;
      EXPECT_EQ(std::ranges::count(outcome.warnings, "beyond_singularity", &Warning::code), end > 0.5) << scheme;
    }
}

// Exact flows and adaptive steps follow the limit of ellipses, which turns back at the centre. This is not the motion:
// as for the problem of the catalogue, there is a warning.
TEST(SingularMotion, IsWarnedOfWhereAFallGoesThroughItsCentre) {
  const auto mechanics = mechanics_of(of(Definition::Kind::potential, {"x", "y"}, {}, "-1/sqrt(x^2 + y^2)"));
  const double collision = std::acos(-1.0) / std::sqrt(8.0);
  for (const char* scheme : {"kepler_splitting", "time_transformed"})
    for (const double angle : {0.0, 0.3})
      for (const double end : {0.9 * collision, 1.1 * collision, 50.0}) {
        const std::vector<double> start{std::cos(angle), std::sin(angle), 0, 0};
        Request request = request_by("leapfrog", mechanics, start, end);
        const auto found = std::ranges::find(mechanics->schemes(), scheme, &SchemeCard::id);
        ASSERT_NE(found, mechanics->schemes().end()) << scheme;
        request.scheme = static_cast<std::size_t>(found - mechanics->schemes().begin());
        request.settings.clear();
        for (const auto& setting : found->parameters) request.settings.push_back(setting.value);
        request.control = true;
        const auto outcome = runs::go(request).outcome;
        EXPECT_EQ(outcome.stop.reason, ReturnCode::completed) << scheme;
        EXPECT_EQ(std::ranges::count(outcome.warnings, "beyond_singularity", &Warning::code), end > collision)
            << scheme << ' ' << angle << ' ' << end;
      }
}

// x = x₀/(1 − x₀t) ends at t = 1/x₀, however small x₀ is, and no run goes beyond.
TEST(SingularMotion, OfWhatBeginsSmallIsKnown) {
  const auto mechanics = mechanics_of(flow({"x"}, {}, {{"x", "x^2"}}));
  for (const char* scheme : {"taylor", "dormand_prince_5", "fehlberg_78", "bulirsch_stoer"})
    for (const double start : {1.0, 0.1, 0.01, 1e-3, 1e-4, 1e-6}) {
      const auto stop = runs::go(request_by(scheme, mechanics, std::vector{start}, 2 / start)).outcome.stop;
      EXPECT_EQ(stop.reason, ReturnCode::singular) << scheme << ' ' << start;
      ASSERT_TRUE(stop.singular_at) << scheme << ' ' << start;
      EXPECT_NEAR(*stop.singular_at * start, 1, 1e-5) << scheme << ' ' << start;
      if (scheme == std::string_view("taylor")) {
        EXPECT_GE(*stop.singular_at, stop.t) << start;
      }
    }
}

// Close to a removable singularity one of the two series of a reference may run out of digits. The result must not
// depend on which of the two threads is faster.
TEST(RemovableSingularity, HasOneReferenceWhoeverIsFaster) {
  Request request = typed_as(runs::defaults("kepler", "runge_kutta_4"),
                             mechanics_of(of(Definition::Kind::potential, {"x"}, {}, "sin(x)/x")));
  runs::scene(request).initial = {1e-11, 1};
  request.end = 0.5;
  runs::only_final(request);
  runs::ask(request, "error");
  const double first = runs::number(runs::go(request).outcome.diagnostics, "error/final");
  EXPECT_LT(first, 1e-10);
  for (int i = 0; i < 40; ++i)
    ASSERT_EQ(runs::number(runs::go(request).outcome.diagnostics, "error/final"), first) << i;
}

}  // namespace
