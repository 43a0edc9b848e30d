// What a merge says of itself, as the built binary does it.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "server/decode/json_parse.hpp"
#include "tests/server/process.hpp"

namespace least::server::test {
namespace {

// How far a merge carries is said where it is done: of what it took, and of blocks of 4,096 members.
TEST(Command, MergeSaysWhatItTakes) {
  const std::string part = testing::TempDir() + "least_part";
  std::filesystem::remove(part);
  const std::string members = R"({"problem":"kepler","scheme":"leapfrog","until":{"t":1},
      "members":{"count":9000,"vary":{"/initial/x":{"uniform":[0,1]}}}})";
  EXPECT_EQ(Process({"ensemble", "-", "--shard", "0/1", "--output", part}, members).wait(), 0);
  Process merge({"merge", part});
  EXPECT_EQ(Json::parse(merge.output())["completed"], 9000);
  const std::string said = merge.errors();
  EXPECT_NE(said.find("merged blocks=3 "), std::string::npos) << said;
  const auto number = [&](const std::string& name) {
    const auto at = said.find(name + '=');
    return at == std::string::npos ? std::nan("") : std::stod(said.substr(at + name.size() + 1));
  };
  EXPECT_NEAR(number("microseconds_a_block") * 3, number("seconds") * 1e6, 1e-3 * number("seconds") * 1e6);
  EXPECT_NEAR(number("hours_for_1e12_members"), number("microseconds_a_block") * 1e6 / 4096 / 3600,
              1e-3 * number("hours_for_1e12_members"));
  std::filesystem::remove(part);
}

}  // namespace
}  // namespace least::server::test
