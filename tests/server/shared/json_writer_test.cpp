#include "server/shared/json_writer.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <vector>

namespace least::server {
namespace {

using Json = nlohmann::ordered_json;

std::string text(double x) {
  std::string out;
  append_number(out, x);
  return out;
}

// The layout is fmt's, number for number: bit patterns at random, and decimals short and long.
TEST(JsonWriter, NumbersLookAsFmtWritesThem) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 1'000'000; ++i) {
    const std::uint64_t bits = random();
    const double x = i % 2 ? std::bit_cast<double>(bits)
                           : static_cast<double>(static_cast<std::int64_t>(bits >> i % 60)) * std::pow(10, -(i % 23));
    if (!std::isfinite(x) || x == 0) continue;
    ASSERT_EQ(text(x), fmt::format("{}", x));
    ASSERT_LE(text(x).size(), longest_number);
  }
  for (const double x : {5e-324, 2.2250738585072014e-308, 1.7976931348623157e308, 1e15, 1e16, 1e17,
                         123456789012345678.0, 9007199254740993.0, 1e-4, 1e-5, 0.1, -0.3, 100.0, 12.5})
    EXPECT_EQ(text(x), fmt::format("{}", x));
}

TEST(JsonWriter, NumbersReadBackToTheSameDouble) {
  std::mt19937_64 random(7);
  std::vector<double> numbers{0.0, -0.0, 0.1, 20, -3, 1e16, 1e22, 1e300, 5e-324, 1.7976931348623157e308, 1.0 / 3};
  for (int i = 0; i < 10'000; ++i) numbers.push_back(std::bit_cast<double>(random()));
  for (const double x : numbers) {
    if (!std::isfinite(x)) continue;
    const Json json = Json::parse(text(x));
    EXPECT_EQ(std::bit_cast<std::uint64_t>(json.get<double>()), std::bit_cast<std::uint64_t>(x)) << text(x);
  }
  EXPECT_EQ(text(0.1), "0.1");
  EXPECT_EQ(text(std::numeric_limits<double>::infinity()), "null");
  EXPECT_EQ(text(std::nan("")), "null");
}

TEST(JsonWriter, StringsAreEscaped) {
  std::string out;
  append_string(out, std::string_view("a\"\\\n\x01\x7F θ\xFF", 10));
  EXPECT_EQ(Json::parse(out).get<std::string>(), "a\"\\\n\x01\x7F θ\uFFFD");
  out.clear();
  append_string(out, "θ𝄞", true);
  EXPECT_EQ(out, R"("\u03b8\ud834\udd1e")");
}

}  // namespace
}  // namespace least::server
