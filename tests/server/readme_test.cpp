// Every request that the README shows is answered, and the first one with the answer shown under it.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>

#include "tests/server/client.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

using Json = nlohmann::json;

std::string readme() {
  std::ifstream file(LEAST_SOURCE_DIR "/README.md");
  return {std::istreambuf_iterator<char>(file), {}};
}

struct Shown {
  std::string path, body;
};
/// requests() returns what the README's lines of curl send.
std::vector<Shown> requests(const std::string& text) {
  static const std::regex curl(R"(\ncurl http://127\.0\.0\.1:8080(/v1/\S+) -d '([^']*)')");
  std::vector<Shown> all;
  for (std::sregex_iterator it(text.begin(), text.end(), curl), end; it != end; ++it)
    all.push_back({(*it)[1].str(), (*it)[2].str()});
  return all;
}

class Readme : public Serving {};

TEST_F(Readme, EveryRequestIsAnswered) {
  const std::string text = readme();
  std::size_t lines = 0;
  for (auto at = text.find("\ncurl "); at != text.npos; at = text.find("\ncurl ", at + 1)) ++lines;
  const auto all = requests(text);
  EXPECT_EQ(all.size(), lines) << "a line of curl is written as no other";
  EXPECT_GE(all.size(), 4U);
  for (const auto& [path, body] : all) {
    const Json named = Json::parse(body)["problem"];
    const std::string problem = named.is_string() ? named.get<std::string>() : named["id"].get<std::string>();
    if (std::string(LEAST_LEFT_OUT).find(' ' + problem + ' ') != std::string::npos) continue;
    const Reply reply = ask(port(), post(path, body));
    ASSERT_EQ(reply.status, 200) << body << reply.body;
    const Json answer = Json::parse(reply.body);
    EXPECT_EQ(answer.value("status", "completed"), path == "/v1/periodic" ? "closed" : "completed") << body;
  }
}

TEST_F(Readme, ShowsTheAnswerToItsRequest) {
  const std::string text = readme(), fence = "```json\n";
  const auto begin = text.find(fence) + fence.size();
  const auto all = requests(text);
  ASSERT_FALSE(all.empty());
  Json expected = Json::parse(text.substr(begin, text.find("\n```", begin) - begin));
  Json got = Json::parse(ask(port(), post(all[0].path, all[0].body)).body);
  EXPECT_TRUE(got.contains("cost") && expected.contains("cost"));
  got.erase("cost");
  expected.erase("cost");
  got.erase("version");  // the project's, which only CMakeLists.txt has
  expected.erase("version");
  EXPECT_EQ(got, expected);
}

/// The members of an answer that the README names make a complete request.
TEST_F(Readme, TheEchoIsARequest) {
  const auto all = requests(readme());
  ASSERT_FALSE(all.empty());
  const Json first = Json::parse(ask(port(), post(all[0].path, all[0].body)).body);
  Json echo;
  for (const auto* member : {"problem", "initial", "scheme", "until", "record", "columns", "limits", "norm"})
    echo[member] = first.at(member);
  const Json again = Json::parse(ask(port(), post(all[0].path, echo.dump())).body);
  EXPECT_EQ(again.at("trajectory"), first.at("trajectory"));
  EXPECT_EQ(again.at("final"), first.at("final"));
}

}  // namespace
}  // namespace least::server::test
