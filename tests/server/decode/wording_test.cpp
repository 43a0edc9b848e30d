#include "server/decode/wording.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "server/http/accept.hpp"

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

TEST(Accept, WeighsMediaRanges) {
  const std::string_view offered[] = {"application/json", "text/csv"};
  const auto chosen = [&](std::string_view accept) { return negotiate(accept, offered); };
  EXPECT_EQ(chosen(""), 0u);
  EXPECT_EQ(chosen("*/*"), 0u);
  EXPECT_EQ(chosen("text/csv"), 1u);
  EXPECT_EQ(chosen("TEXT/CSV; header=present"), 1u);
  EXPECT_EQ(chosen("text/*"), 1u);
  EXPECT_EQ(chosen("application/json;q=0.5, text/csv"), 1u);
  EXPECT_EQ(chosen("text/csv;q=0.5, */*;q=0.1"), 1u);
  EXPECT_EQ(chosen("text/csv; q=0.5 , */* ; Q=0.6"), 0u);
  EXPECT_EQ(chosen("application/json;q=0, */*"), 1u);
  EXPECT_EQ(chosen("text/html, application/xhtml+xml, */*;q=0.8"), 0u);
  EXPECT_EQ(chosen("application/cbor"), std::nullopt);
  EXPECT_EQ(chosen("application/x-ndjson, text/*;q=0"), std::nullopt);
  EXPECT_EQ(chosen(",;q=,;;,"), std::nullopt);
}

}  // namespace
}  // namespace least::server
