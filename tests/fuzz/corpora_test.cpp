// The targets of the fuzzer over the bytes it has found worth keeping, and over those that once broke them.
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <random>
#include <string>

#include "tests/fuzz/targets.hpp"

namespace least::fuzz {
namespace {

class Corpus : public testing::TestWithParam<Target> {};

TEST_P(Corpus, HoldsNothingThatBreaksItsTarget) {
  std::size_t files = 0;
  const auto folder = std::filesystem::path(LEAST_SOURCE_DIR) / "tests/fuzz/corpus" / GetParam().name;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    std::ifstream file(entry.path(), std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    EXPECT_NO_THROW(GetParam().check(bytes)) << entry.path();
    ++files;
  }
  EXPECT_GT(files, 0U) << folder;
}

INSTANTIATE_TEST_SUITE_P(Of, Corpus, testing::ValuesIn(targets),
                         [](const auto& each) { return std::string(each.param.name); });

// Covers all good requests, some of them twice. On a busy machine there may be no time to choose a scheme.
TEST(Values, BeginWithGoodRequests) {
  for (char first = 0; first < 40; ++first) {
    int status = 422;
    for (int tries = 0; tries < 3 && status == 422; ++tries) status = status_of_values(std::string{first, '\0', '\0'});
    EXPECT_NE(status, 422) << static_cast<int>(first);
  }
}

// Random choices are mostly good: half of the requests run, because the target would learn little from refusals.
TEST(Values, MostlyRun) {
  std::minstd_rand random(1);
  std::map<int, int> found;
  for (int i = 0; i < 400; ++i) {
    std::string bytes(40, '\0');
    for (char& byte : bytes) byte = static_cast<char>(random() >> 8);
    EXPECT_NO_THROW(++found[status_of_values(bytes)]) << i;
  }
  std::printf("%d ran, %d were refused, for %d there was no memory, %d are left out\n", found[200], found[422],
              found[503], found[0]);
  EXPECT_GE(2 * found[200], 400 - found[0]);
}

}  // namespace
}  // namespace least::fuzz
