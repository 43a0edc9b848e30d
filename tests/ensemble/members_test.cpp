// Members as a function of (seed, index), and sums that do not depend on how the work is distributed.
#include "core/ensemble/members.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/ensemble/block.hpp"
#include "core/ensemble/philox.hpp"

namespace {

using namespace least;

TEST(Philox, IsThatOfItsPublication) {  // known answers of Random123, kat_vectors
  EXPECT_EQ(philox({}, {}), (PhiloxCounter{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  const std::uint32_t f = 0xffffffff;
  EXPECT_EQ(philox({f, f, f, f}, {f, f}), (PhiloxCounter{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (PhiloxCounter{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(Quantiles, AreInversesOfTheirDistributions) {
  for (const double p : {0x1p-53, 1e-12, 1e-6, 0.01, 0.07, 0.08, 0.3, 0.5, 0.6, 0.93, 0.999, 1 - 1e-9}) {
    const double x = normal_quantile(p);
    EXPECT_NEAR(0.5 * std::erfc(-x / std::numbers::sqrt2), p, 1e-14 * (1 + x * x) * std::min(p, 0.5)) << p;
    EXPECT_NEAR(1 / (1 + std::exp(-logistic_quantile(p))), p, 1e-13 * p) << p;
  }
  EXPECT_EQ(normal_quantile(0.5), 0);
  EXPECT_NEAR(normal_quantile(0.975), 1.959963984540054, 9e-16);
}

TEST(Members, GridsAndValuesMakeTheirProductTheLastFastest) {
  const Members members{
      6, 0, {{Varied::variable, 0, Spread::grid, {1, 2, 3}}, {Varied::parameter, 0, Spread::values, {7, -7}}}};
  const std::vector<std::vector<double>> all{{1, 7}, {1, -7}, {1.5, 7}, {1.5, -7}, {2, 7}, {2, -7}};
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(members.of(static_cast<std::int64_t>(i)), all[i]);
  const Members lone{1, 0, {{Varied::variable, 0, Spread::grid, {0.3, 0.3, 1}}}};
  EXPECT_EQ(lone.of(0), std::vector<double>{0.3});
}

/// Members do not depend on the order in which a request lists what varies: each number is the draw of its own
/// quantity.
TEST(Members, DrawsDoNotDependOnTheOrderOfVariations) {
  const Variation x{Varied::variable, 0, Spread::uniform, {0, 1}}, v{Varied::velocity, 0, Spread::uniform, {0, 1}},
      k{Varied::parameter, 2, Spread::normal, {0, 1}};
  const Members in_order{9, 5, {x, v, k}}, mixed{9, 5, {k, x, v}};
  for (std::int64_t i = 0; i < in_order.count; ++i) {
    const auto a = in_order.of(i), b = mixed.of(i);
    EXPECT_EQ(a, (std::vector<double>{b[1], b[2], b[0]})) << i;
    EXPECT_EQ(a[0], uniform(5, static_cast<std::uint64_t>(i), 0));
    EXPECT_EQ(a[1], uniform(5, static_cast<std::uint64_t>(i), 1));
  }
}

TEST(Members, DrawsFollowFromSeedAndIndex) {
  const Variation around{Varied::variable, 1, Spread::normal, {2, 0.5}},
      within{Varied::variable, 0, Spread::uniform, {-1, 3}};
  Members members{100000, 7, {within, around}};
  double mean = 0, square = 0, least = 9, most = -9, skew = 0;
  for (std::int64_t i = 0; i < members.count; ++i) {
    const auto x = members.of(i);
    least = std::min(least, x[0]);
    most = std::max(most, x[0]);
    mean += x[0] / 1e5;
    const double z = (x[1] - 2) / 0.5;
    square += z * z / 1e5;
    skew += z * (x[0] - 1) / 1e5;
  }
  // The tolerances are four standard errors.
  EXPECT_NEAR(mean, 1, 4 * (4 / std::sqrt(12)) / std::sqrt(1e5));
  EXPECT_NEAR(square, 1, 4 * std::sqrt(2 / 1e5));
  EXPECT_NEAR(skew, 0, 4 * (4 / std::sqrt(12)) / std::sqrt(1e5)) << "two quantities of a member are independent";
  EXPECT_GE(least, -1);
  EXPECT_LE(most, 3);
  EXPECT_LT(least, -0.999);
  EXPECT_GT(most, 2.999);
  const auto fifth = members.of(5);
  Members other = members;
  other.seed = 8;
  EXPECT_NE(other.of(5), fifth);
  other.seed = members.seed + (std::uint64_t{1} << 32U);
  EXPECT_NE(other.of(5), fifth);
  EXPECT_NE(members.of(5 + (std::int64_t{1} << 32U)), fifth);
  other = {9, 7, {within}};
  EXPECT_EQ(other.of(5)[0], fifth[0]) << "neither on the number of members nor on what else varies";
}

TEST(Moments, OfBlocksAreThoseOfAll) {
  std::vector<double> all, block;
  Moments merged;
  for (int i = 0; i < 1000; ++i) {
    const double x = 1e6 + std::sin(i * i);
    all.push_back(x);
    block.push_back(x);
    if (block.size() == 130 || i == 999) {
      merged.add(Moments::of(block));
      block.clear();
    }
  }
  const Moments direct = Moments::of(all);
  EXPECT_EQ(merged.count, 1000);
  EXPECT_NEAR(merged.mean, direct.mean, 1e-9);
  EXPECT_NEAR(merged.variance(), direct.variance(), 1e-9);
  EXPECT_NEAR(direct.variance(), 0.5, 0.05);
  EXPECT_EQ(merged.minimum, direct.minimum);
  EXPECT_EQ(merged.maximum, direct.maximum);
  const Moments gaps = Moments::of({1, std::nan(""), 3});
  EXPECT_EQ(gaps.count, 2) << "what cannot be said does not count";
  EXPECT_EQ(gaps.mean, 2);
  EXPECT_EQ(gaps.variance(), 2);
  EXPECT_TRUE(std::isnan(Moments::of({1}).variance()));
}

TEST(Histogram, CountsEveryValueOnce) {
  const HistogramAsked asked{0, -1, 1, 4};
  Histogram h{{0, 0, 0, 0}};
  for (const double x : {-1.0, -0.5, std::nextafter(1.0, 0.0), 1.0, -1.1, 0.0, 0.2}) h.count(asked, x);
  EXPECT_EQ(h.counts, (std::vector<std::int64_t>{1, 1, 2, 1}));
  EXPECT_EQ(h.below, 1);
  EXPECT_EQ(h.above, 1);
  Histogram twice = h;
  twice.add(h);
  EXPECT_EQ(twice.counts, (std::vector<std::int64_t>{2, 2, 4, 2}));
  EXPECT_EQ(twice.below, 2);
}

}  // namespace
