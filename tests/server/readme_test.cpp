// The README's curl line gives the answer that stands under it.
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

namespace {

std::string between(const std::string& text, const std::string& from, const std::string& to) {
  const auto begin = text.find(from) + from.size();
  return text.substr(begin, text.find(to, begin) - begin);
}

TEST(Readme, ShowsTheAnswerToItsRequest) {
  std::ifstream file(LEAST_SOURCE_DIR "/README.md");
  const std::string readme((std::istreambuf_iterator<char>(file)), {});
  const std::string request = between(readme, "-d '", "'\n```"), shown = between(readme, "```json\n", "\n```");
  ASSERT_NE(request.find("leapfrog"), std::string::npos);

  const std::string path = testing::TempDir() + "readme_request.json";
  std::ofstream(path) << request;
  FILE* pipe = popen((std::string(LEAST_BINARY) + " run " + path).c_str(), "r");
  ASSERT_TRUE(pipe);
  std::string answer;
  char block[4096];
  while (const auto n = fread(block, 1, sizeof block, pipe)) answer.append(block, n);
  ASSERT_EQ(pclose(pipe), 0);

  auto got = nlohmann::json::parse(answer), expected = nlohmann::json::parse(shown);
  EXPECT_TRUE(got.contains("cost") && expected.contains("cost"));
  got.erase("cost");
  expected.erase("cost");
  EXPECT_EQ(got, expected);
}

}  // namespace
