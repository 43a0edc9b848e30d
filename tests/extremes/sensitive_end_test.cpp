// Runs say until when the digits of a chaotic motion mean something, whatever was asked for; regular motions have no
// such warning.
#include <gtest/gtest.h>

#include <cstdio>
#include <random>

#include "tests/extremes/asking.hpp"

namespace {

using namespace least;
using namespace asking;

Request controlled(Request request) {
  request.control = true;
  request.limits = {};
  request.record.count = 0;
  return request;
}
/// named_time() returns the time that the warning `sensitive_end` names.
double named_time(const runs::Result& result) {
  for (const Warning& warning : result.outcome.warnings)
    if (warning.code == "sensitive_end") {
      const std::string detail = warning.detail.text();
      const auto place = detail.find("t = ");
      return std::stod(detail.substr(place + 4));
    }
  return null;
}
double apart(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

// The motion is too long to be followed with a tangent by the operations allowed; how fast differences grow until then
// tells when those that the tolerance leaves are as large as the motion. The run is off by a tenth at its end.
TEST(SensitiveEnd, IsForeseenFromTheToleranceOfARun) {
  const auto result = go(until(controlled(of("thermostat", {"taylor"}, {})), 100));
  ASSERT_TRUE(warned(result, "sensitive_end"));
  EXPECT_GT(named_time(result), 60);
  EXPECT_LT(named_time(result), 95);
  EXPECT_FALSE(warned(go(until(controlled(of("thermostat", {"taylor"}, {})), 40)), "sensitive_end"));
}

// Random Hénon–Heiles orbits between a sixth of the escape energy and all of it: two unrelated schemes, each at the
// best accuracy it can reach, show whether the end is noise, and until when they agree.
TEST(SensitiveEnd, IsSaidWhereTwoSchemesPartAndNowhereElse) {
  std::mt19937_64 random(41);
  std::uniform_real_distribution<double> any(0, 1);
  int noise = 0, sure = 0, right_time = 0;
  for (int n = 0; n < 40; ++n) {
    const double level = (1 + 5 * any(random)) / 36, y = 0.4 * any(random) - 0.2, angle = 2 * pi * any(random),
                 p = std::sqrt(2 * (level - y * y / 2 + y * y * y / 3));
    const auto start = [&](const Scheme& scheme) {
      return controlled(at(of("henon_heiles", scheme, {}),
                           {{"x", 0}, {"y", y}, {"px", p * std::cos(angle)}, {"py", p * std::sin(angle)}}));
    };
    const Request one = start({"taylor"}), other = start({"fehlberg_78", {{"tolerance", 1e-14}}});
    const auto ends = [&](double t) {
      return apart(go(until(one, t)).outcome.final, go(until(other, t)).outcome.final);
    };
    const double end = 1500, parted = ends(end);
    const auto result = go(until(one, end));
    if (parted > 0.3) {
      ++noise;
      EXPECT_TRUE(warned(result, "sensitive_end")) << n << ": E = " << level << ", apart " << parted;
      const double named = named_time(result);
      right_time += ends(0.75 * named) < 0.1 && named < end;
    } else if (parted < 1e-6) {
      ++sure;
      EXPECT_FALSE(warned(result, "sensitive_end")) << n << ": E = " << level << ", apart " << parted;
    }
  }
  std::printf("noise %d, sure %d, right time %d\n", noise, sure, right_time);
  EXPECT_GT(noise, 4);
  EXPECT_GT(sure, 10);
  EXPECT_GE(right_time, noise - noise / 10);
}

// For schemes of fewer digits the time is earlier.
TEST(SensitiveEnd, DependsOnTheSchemesOwnError) {
  const auto chaotic = [](const Scheme& scheme) {
    return go(until(controlled(at(of("henon_heiles", scheme, {}), {{"x", 0}, {"y", -0.1}, {"px", 0.55}, {"py", 0.05}})),
                    600));
  };
  const auto coarse = chaotic({"leapfrog", {{"step", 0.05}}}), fine = chaotic({"leapfrog", {{"step", 0.001}}}),
             best = chaotic({"taylor"});
  EXPECT_LT(named_time(coarse), named_time(fine));
  EXPECT_LT(named_time(fine), named_time(best));
  EXPECT_LT(named_time(best), 600);
}

TEST(SensitiveEnd, IsNotSaidOfRegularMotion) {
  for (const char* scheme : {"leapfrog", "taylor", "dormand_prince_5", "runge_kutta_4"}) {
    EXPECT_FALSE(warned(go(until(controlled(of("kepler", {scheme}, {})), 1900)), "sensitive_end")) << scheme;
    EXPECT_FALSE(warned(go(until(controlled(of("harmonic_oscillator", {scheme}, {})), 1e4)), "sensitive_end"))
        << scheme;
    EXPECT_FALSE(warned(go(until(controlled(of("henon_heiles", {scheme}, {})), 2000)), "sensitive_end")) << scheme;
  }
  // Steps that are too long have a larger error than the growth of differences explains: that is another warning.
  const auto coarse = go(until(controlled(of("henon_heiles", {"leapfrog", {{"step", 0.3}}}, {})), 1500));
  EXPECT_TRUE(warned(coarse, "large_error"));
  EXPECT_FALSE(warned(coarse, "sensitive_end"));
  for (const char* scheme : {"taylor", "dormand_prince_5"})
    EXPECT_FALSE(warned(go(until(controlled(of("van_der_pol", {scheme}, {})), 1000)), "sensitive_end")) << scheme;
}

}  // namespace
