#include "server/shared/json_writer.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace least::server {
namespace {

using Json = nlohmann::ordered_json;

std::string text(double x) {
  std::string out;
  append_number(out, x);
  return out;
}

// digits() returns the significant digits of a number, without what the layout adds.
std::string digits(std::string_view number) {
  std::string found;
  for (const char c : number.substr(0, number.find('e'))) {
    if (c >= '0' && c <= '9' && !(found.empty() && c == '0')) found += c;
  }
  return found.substr(0, found.find_last_not_of('0') + 1);
}

TEST(JsonWriter, NumbersAreLaidOutAlikeEverywhere) {
  for (const auto& [x, expected] :
       std::vector<std::pair<double, std::string>>{{0, "0"},
                                                   {-0.0, "-0.0"},
                                                   {100, "100"},
                                                   {12.5, "12.5"},
                                                   {-0.3, "-0.3"},
                                                   {1e-4, "0.0001"},
                                                   {1e-5, "1e-05"},
                                                   {-1.5e-10, "-1.5e-10"},
                                                   {1e15, "1000000000000000"},
                                                   {1e16, "1e+16"},
                                                   {9007199254740993.0, "9007199254740992"},
                                                   {123456789012345678.0, "1.2345678901234568e+17"},
                                                   {1e100, "1e+100"},
                                                   {5e-324, "5e-324"},
                                                   {-2.2250738585072014e-308, "-2.2250738585072014e-308"},
                                                   {1.7976931348623157e308, "1.7976931348623157e+308"}}) {
    EXPECT_EQ(text(x), expected);
  }
}

TEST(JsonWriter, NumbersAreTheShortestOnes) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 1'000'000; ++i) {
    const std::uint64_t bits = random();
    const double x = i % 2 ? std::bit_cast<double>(bits)
                           : static_cast<double>(static_cast<std::int64_t>(bits >> i % 60)) * std::pow(10, -(i % 23));
    if (!std::isfinite(x)) continue;
    char shortest[32];
    const auto end = std::to_chars(shortest, shortest + sizeof shortest, x, std::chars_format::scientific).ptr;
    ASSERT_EQ(digits(text(x)), digits({shortest, end}));
    ASSERT_LE(text(x).size(), longest_number);
  }
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
