#include "server/decode/wording.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace least::server {
namespace {

TEST(Wording, NumbersAndRangesAreShort) {
  EXPECT_EQ(shortest(1000), "1e3");
  EXPECT_EQ(shortest(100), "100");
  EXPECT_EQ(shortest(0.5), "0.5");
  EXPECT_EQ(shortest(0), "0");
  EXPECT_EQ(shortest(-1e-7), "-1e-7");
  EXPECT_EQ(shortest(1e300), "1e300");
  EXPECT_EQ(interval({0, 1e3, true, false}), "(0, 1e3]");
  EXPECT_EQ(interval({1, std::numeric_limits<double>::infinity()}), "[1, inf)");
}

TEST(Wording, FindsWhatWasMeant) {
  const Names names{"leapfrog", "symplectic_euler", "explicit_euler", "kepler", "t"};
  EXPECT_EQ(closest("leepfrog", names), "leapfrog");
  EXPECT_EQ(closest("laepfrog", names), "leapfrog");
  EXPECT_EQ(closest("Leapfrog", names), "leapfrog");
  EXPECT_EQ(closest("kelper", names), "kepler");
  EXPECT_EQ(closest("simplectic-euler", names), "symplectic_euler");
  EXPECT_EQ(closest("x", names), "");
  EXPECT_EQ(closest("bulirsch", names), "");
  EXPECT_EQ(closest(std::string(100'000, 'l'), names), "");
}

TEST(Wording, KnowsWhatOthersCallThings) {
  const Names schemes{"explicit_euler", "explicit_midpoint", "leapfrog", "runge_kutta_4"};
  EXPECT_EQ(closest("rk4", schemes), "runge_kutta_4");
  EXPECT_EQ(closest("RK4", schemes), "runge_kutta_4");
  EXPECT_EQ(closest("stormer_verlet", schemes), "leapfrog");
  EXPECT_EQ(closest("euler", schemes), "explicit_euler");
  EXPECT_EQ(closest("midpoint", schemes), "explicit_midpoint");
  EXPECT_EQ(closest("dt", Names{"id", "step"}), "step");
  EXPECT_NE(closest("dt", Names{"id", "tolerance"}), "step") << "only what there is";
}

}  // namespace
}  // namespace least::server
