// Devices and pipes that never end, or never begin, in the place of a file.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "tests/server/ensembles.hpp"
#include "tests/server/process.hpp"
#include "tests/server/temporary_folder.hpp"

namespace least::server::test {
namespace {

class NoFiles : public testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0); }
  std::string path(const std::string& name) const { return folder_.path(name); }

  TemporaryFolder folder_;
};

// merge_of() returns what a merge says of a path.
std::string merge_of(const std::string& path) {
  Process merge({"merge", path});
  std::string said = merge.output();
  EXPECT_EQ(merge.wait(), 2) << path;
  return said;
}

TEST_F(NoFiles, AreNoParts) {
  for (const std::string& name : {std::string("/dev/zero"), std::string("/dev/full"), path("pipe")})
    EXPECT_NE(merge_of(name).find(name + " is no file"), std::string::npos) << name;
}

// A file that was enlarged by mistake costs no memory.
TEST_F(NoFiles, ALineWithoutAnEndIsNoPart) {
  std::ofstream(path("long")) << '{';
  std::filesystem::resize_file(path("long"), std::uintmax_t{1} << 33);  // holes
  EXPECT_NE(merge_of(path("long")).find("longer than those of any"), std::string::npos);
  std::ofstream(path("zeros")) << '\0';
  std::filesystem::resize_file(path("zeros"), std::uintmax_t{1} << 33);
  EXPECT_NE(merge_of(path("zeros")).find("is no part of an ensemble"), std::string::npos);
}

TEST_F(NoFiles, TakeNoPart) {
  for (const std::string& name : {std::string("/dev/full"), std::string("/dev/zero"), path("pipe")}) {
    Process shard({"ensemble", "-", "--shard", "0/1", "--output", name}, orbits);
    EXPECT_NE(shard.output().find(name + " is there and is no part of an ensemble"), std::string::npos) << name;
    EXPECT_EQ(shard.wait(), 2) << name;
  }
}

// A request may come through a pipe, as from a shell; a pipe whose other end nobody holds is not waited for for ever.
TEST_F(NoFiles, ARequestMayComeThroughAPipe) {
  Process run({"run", path("pipe")});
  std::ofstream(path("pipe")) << R"({"problem":"kepler","scheme":"leapfrog","record":{"every":0}})";
  EXPECT_NE(run.output().find("\"status\":\"completed\""), std::string::npos);
  EXPECT_EQ(run.wait(), 0);
}

TEST_F(NoFiles, ADeviceWithoutAnEndIsNoRequest) {
  Process run({"run", "/dev/zero"});
  EXPECT_NE(run.output().find("larger than"), std::string::npos);
  EXPECT_EQ(run.wait(), 2);
}

}  // namespace
}  // namespace least::server::test
