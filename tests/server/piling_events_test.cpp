// Events that act ever sooner, over HTTP: those that pile up, and those whose intervals do not vanish.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/server/balls.hpp"
#include "tests/server/client.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

class PilingEvents : public Asking {};

// Bounces that have only been geometric so far do not stop a run: a ball is thrown again once it is slow, and intervals
// may shrink to a length above the rounding of the time.
TEST_F(PilingEvents, GoOnWhereTheIntervalsBetweenThemDoNotVanish) {
  Json thrown = ball(0.8);
  thrown["events"][0]["set"] = {{"vx", "if(vx > -1e-6, 3, -r*vx)"}};
  thrown["events"][0]["most"] = 70;
  thrown["until"] = 100;
  Json made = answer(thrown);
  EXPECT_EQ(made["end"], Json::parse(R"({"event":"floor","count":70})")) << made["stop"];
  EXPECT_GT(made["final"]["t"], 30);

  // The speed doubles at each passage, up to 1e8: the intervals shrink from 1 to 1e-8.
  Json passing = ball(1);
  passing["problem"]["potential"] = "0*x";
  passing["initial"] = {{"vx", 1}};
  passing["events"][0] = {
      {"name", "end"}, {"expression", "x-1"}, {"set", {{"x", "0"}, {"vx", "min(2*vx, 1e8)"}}}, {"most", 100}};
  made = answer(passing);
  EXPECT_EQ(made["end"]["count"], 100) << made["stop"];
  double time = 0;
  for (int n = 0; n < 100; ++n) time += 1 / std::min(std::exp2(n), 1e8);
  EXPECT_NEAR(made["final"]["t"], time, 1e-13);
  // Without that bound they pile up at 1 + 1/2 + 1/4 …, also where the speed is squared each time.
  passing["events"][0].erase("most");
  passing["events"][0]["set"]["vx"] = "2*vx";
  made = answer(passing);
  EXPECT_EQ(made["stop"]["reason"], "accumulating_events") << made["final"];
  EXPECT_NEAR(made["stop"]["singular_at"], 2, 1e-14);
  passing["initial"]["vx"] = 2;
  passing["events"][0]["set"]["vx"] = "vx^2";
  made = answer(passing);
  EXPECT_EQ(made["stop"]["reason"], "accumulating_events") << made["final"];
  EXPECT_NEAR(made["stop"]["singular_at"], 1 / 2. + 1 / 4. + 1 / 16. + 1 / 256. + 1 / 65536. + 1 / 4294967296., 1e-14);

  // What an act adds keeps a rebound at 5e-7, and the interval at 1e-6.
  Json kept = ball(0.8);
  kept["events"][0]["set"] = {{"vx", "-r*vx + 1e-7"}};
  kept["events"][0]["most"] = 500;
  made = answer(kept);
  EXPECT_EQ(made["end"]["count"], 500) << made["stop"];
  EXPECT_NEAR(made["final"]["px"], 5e-7, 1e-14);
}

// A ball that loses little at a bounce stops, too, also where the rounding of its place gives back what it loses.
TEST_F(PilingEvents, PileUpWhereLittleIsLostAtEach) {
  for (const char* scheme : {"leapfrog", "dormand_prince_5"})
    for (const double r : {0.99, 0.997}) {
      Json request = ball(r);
      request["scheme"] = scheme;
      request["until"] = 2000;
      request["initial"]["x"] = -299;
      request["events"][0]["expression"] = "x + 300";
      const Json made = answer(request);
      EXPECT_EQ(made["stop"]["reason"], "accumulating_events") << scheme << r << made["stop"];
      EXPECT_NEAR(made["stop"]["singular_at"], std::sqrt(2.0) * (1 + r) / (1 - r), 1e-3) << scheme << r;
    }
}

}  // namespace
}  // namespace least::server::test
