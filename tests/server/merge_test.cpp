// Parts of ensembles: they are written whole or not at all, and merge.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <thread>

#include "core/catalogue/catalogue.hpp"
#include "server/endpoint.hpp"
#include "server/shards.hpp"
#include "tests/server/ensembles.hpp"
#include "tests/server/process.hpp"
#include "tests/server/temporary_folder.hpp"

namespace least::server::test {
namespace {

// The standard error of a merge says how much it took, in blocks of 4,096 members.
TEST(Command, MergeSaysWhatItTakes) {
  const std::string part = testing::TempDir() + "least_part";
  std::filesystem::remove(part);
  const std::string members = R"({"problem":"kepler","scheme":"leapfrog","until":{"t":1},
      "initial":{"y":0,"px":0,"py":0.1},"members":{"count":9000,"vary":{"/initial/x":{"uniform":[0,1]}}}})";
  EXPECT_EQ(Process({"ensemble", "-", "--shard", "0/1", "--output", part}, members).wait(), 0);
  Process merge({"merge", part}), direct({"ensemble", "-"}, members);
  const std::string merged = merge.output();
  EXPECT_GT(Json::parse(merged)["completed"], 0);
  EXPECT_FALSE(Json::parse(merged)["warnings"].empty()) << "orbits this close to their centre are wrong";
  EXPECT_EQ(without_cost(merged).dump(), without_cost(direct.output()).dump());
  EXPECT_TRUE(Json::parse(merged)["cost"]["seconds"].is_null()) << "parts do not say how long their members took";
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

// Parts of an ensemble in a folder of their own.
class EnsembleParts : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return folder_.path(name); }
  Answer part(const std::string& request, const std::string& shard, const std::string& name) {
    return write_part(context_, {request, "", "test"}, shard, path(name), 2);
  }
  std::string merged(const std::vector<std::string>& names) {
    std::vector<std::string> paths;
    for (const auto& name : names) paths.push_back(path(name));
    return merge_parts(context_.cards, paths, "test").body;
  }
  void expect_refused(const std::vector<std::string>& names, std::string_view words) {
    const std::string said = merged(names);
    EXPECT_NE(said.find("\"status\":422"), std::string::npos) << said.substr(0, 300);
    EXPECT_NE(said.find(words), std::string::npos) << said.substr(0, 300);
  }

  TemporaryFolder folder_;
  std::atomic<bool> cancelled_{false};
  Admission admission_{2, 0};
  MemoryBudget memory_{std::size_t{1} << 30};
  Context context_{catalogue_cards(), {}, admission_, cancelled_, memory_};
};

TEST_F(EnsembleParts, MergeToTheBytesOfOneRun) {
  for (const std::string shard : {"0", "1"}) EXPECT_EQ(part(orbits, shard + "/2", shard).status, 200);
  EXPECT_EQ(part(orbits, "0/1", "all").status, 200);
  const std::string whole = merged({"all"});
  EXPECT_EQ(without_cost(merged({"1", "0"})).dump(), without_cost(whole).dump());
  EXPECT_EQ(whole.substr(0, whole.find("\"cost\"")), merged({"0", "1"}).substr(0, whole.find("\"cost\"")));
  EXPECT_EQ(without_cost(whole)["completed"], 9000);
}

TEST_F(EnsembleParts, MergeWithTrajectories) {
  Json request = Json::parse(orbits);
  request["keep"] = {"trajectories", "final"};
  request["record"] = {{"samples", 3}};
  request["limits"] = {{"steps", 59}};
  request["until"] = {{"t", 3}};
  for (const std::string shard : {"0", "1"}) EXPECT_EQ(part(request.dump(), shard + "/2", shard).status, 200);
  EXPECT_EQ(part(request.dump(), "0/1", "all").status, 200);
  const std::string whole = merged({"all"});
  EXPECT_EQ(whole.substr(0, whole.find("\"cost\"")), merged({"1", "0"}).substr(0, whole.find("\"cost\"")));
  const Json ways = Json::parse(whole)["trajectories"];
  EXPECT_EQ(ways["member"].size(), 9000u);
  EXPECT_EQ(ways["r"][8999].size(), 2u) << "all of them stop before the last sample";
}

// A block in which no member completes has counts of zero.
TEST_F(EnsembleParts, MergeWhereNobodyCompletes) {
  Json request = Json::parse(orbits);
  request["limits"] = {{"steps", 3}};
  for (const std::string shard : {"0", "1"}) EXPECT_EQ(part(request.dump(), shard + "/2", shard).status, 200);
  const Json answer = Json::parse(merged({"0", "1"}));
  EXPECT_EQ(answer["completed"], 0) << answer.dump();
  EXPECT_FALSE(answer["histograms"].empty());
}

TEST_F(EnsembleParts, AreNotComputedTwiceAndReplacedWhereTheyAreNotWhole) {
  EXPECT_EQ(part(orbits, "1/2", "1").body, path("1") + ": 1 blocks\n");
  EXPECT_EQ(part(orbits, "1/2", "1").body, path("1") + ": is whole, nothing was computed\n");
  EXPECT_EQ(part(orbits, "0/2", "1").body, path("1") + ": 2 blocks\n") << "another shard";
  std::filesystem::resize_file(path("1"), std::filesystem::file_size(path("1")) - 1);
  EXPECT_EQ(part(orbits, "0/2", "1").body, path("1") + ": 2 blocks\n") << "truncated";
  Json longer = Json::parse(orbits);
  longer["limits"] = {{"seconds", 0.05}};
  longer["until"]["t"] = 1e5;
  const auto late = part(longer.dump(), "0/2", "late");
  EXPECT_EQ(late.status, 422);
  EXPECT_FALSE(std::filesystem::exists(path("late"))) << "whole or not at all";
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.name()), {}), 1) << "nothing else is left behind";
}

// A part whose bytes were changed, by a disk or by hand, gives no wrong number, and another run repairs it.
TEST_F(EnsembleParts, ThatAreNotWhatWasWrittenAreTold) {
  for (const std::string shard : {"0", "1", "2"}) part(orbits, shard + "/3", shard);
  const std::string good = merged({"0", "1", "2"});
  const auto text_of = [&](const std::string& name) {
    std::ifstream file(path(name), std::ios::binary);
    return std::string{std::istreambuf_iterator<char>(file), {}};
  };
  const auto without_its_third_line = [](std::string text) {
    const auto second = text.find('\n', text.find('\n') + 1) + 1;
    return text.erase(second, text.find('\n', second) + 1 - second);
  };
  const auto with_another_count = [](std::string text) {
    return text.replace(text.find("\"completed\":4096"), 16, "\"completed\":4095");
  };
  const auto twice = [](const std::string& text) { return text + text; };
  const auto damage = [&](const std::string& name, auto&& change) {
    const std::string text = text_of(name);
    std::ofstream(path(name), std::ios::binary) << change(text);
  };
  damage("0", without_its_third_line);
  damage("1", with_another_count);
  expect_refused({"0", "1", "2"}, path("0") + " is damaged: block 0 is not there");
  expect_refused({"0", "1", "2"}, path("1") + " is damaged: it is not what was written");
  damage("2", twice);
  expect_refused({"0", "1", "2"}, path("2") + " is damaged: it is not what was written");
  for (const std::string shard : {"0", "1", "2"})
    EXPECT_EQ(part(orbits, shard + "/3", shard).body, path(shard) + ": 1 blocks\n") << "computed once more";
  EXPECT_EQ(without_cost(merged({"0", "1", "2"})).dump(), without_cost(good).dump());
}

// The exit codes differ, because a queue should retry what failed, but not what was refused.
TEST(Command, EnsemblesThatFailEndOtherwiseThanThoseThatAreRefused) {
  EXPECT_EQ(Process({"ensemble", "-", "--shard", "0/1", "--output", "/nowhere/part"}, orbits).wait(), 1);
  EXPECT_EQ(Process({"ensemble", "-", "--shard", "2/1", "--output", "/nowhere/part"}, orbits).wait(), 2);
}

// A file left behind where a machine fails while it writes is not taken for a part.
TEST_F(EnsembleParts, AreHiddenUntilTheyAreWhole) {
  Json request = Json::parse(orbits);
  request["until"]["t"] = 1e6;
  std::atomic<bool> ended{false};
  std::thread writer([&] {
    part(request.dump(), "0/1", "part.0");
    ended = true;
  });
  std::vector<std::string> names;
  while (names.empty() && !ended) {
    for (const auto& entry : std::filesystem::directory_iterator(folder_.name()))
      names.push_back(entry.path().filename());
  }
  cancelled_ = true;
  writer.join();
  EXPECT_FALSE(names.empty());
  for (const std::string& name : names) EXPECT_EQ(name.front(), '.') << name;
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.name()), {}), 0)
      << "nothing is left where it is told";
}

// A wrong name in --output destroys no other file.
TEST_F(EnsembleParts, TakeThePlaceOfNothingElse) {
  const std::string letter = "{\"kind\":\"letter\"}\n";
  std::ofstream(path("letter")) << letter;
  std::filesystem::create_directory(path("folder"));
  std::filesystem::create_symlink(path("nowhere"), path("link"));
  std::ofstream(path("answer")) << "{\"kind\":\"head\"}\n{\"kind\":\"block\"}\n";
  std::ofstream(path("secret")) << letter;  // root can read it all the same
  std::filesystem::permissions(path("secret"), std::filesystem::perms::none);
  for (const char* name : {"letter", "answer", "folder", "link", "secret"}) {
    const auto answer = part(orbits, "0/2", name);
    EXPECT_EQ(answer.status, 422) << name;
    EXPECT_NE(answer.body.find(path(name) + " is there and is no part of an ensemble"), std::string::npos) << name;
  }
  std::string kept;
  EXPECT_TRUE(std::getline(std::ifstream(path("letter")), kept));
  EXPECT_EQ(kept + '\n', letter);
  for (const char* begun : {"", "{\"ki", "{\"kind\":\"head\"}\n", "{\"kind\":\"head\"}\n{\"kind\":\"sh"}) {
    std::ofstream(path("begun")) << begun;
    EXPECT_EQ(part(orbits, "0/2", "begun").status, 200) << "what a lost machine may have left: " << begun;
  }
}

TEST_F(EnsembleParts, AreRefusedByName) {
  for (const std::string shard : {"0", "1", "2"}) part(orbits, shard + "/3", shard);
  part(orbits, "1/2", "half");
  expect_refused({"0", "2"}, "no part for the shards 1/3");
  expect_refused({"0", "1", "2", "1"}, "is shard 1/3, and so is " + path("1"));
  expect_refused({"0", "1", "2", "half"},
                 path("half") + " is one of 2 shards of this ensemble, and " + path("0") + " one of 3");
  expect_refused({"0", "1", "none"}, path("none") + " cannot be read");
  expect_refused({"0", "1", "none"}, R"("pointer":"/parts/2")");
  std::ofstream(path("text")) << "one\ntwo\n";
  expect_refused({"text", "0"}, path("text") + " is no part");
  std::filesystem::resize_file(path("2"), std::filesystem::file_size(path("2")) - 10);
  expect_refused({"0", "1", "2"}, path("2") + " is truncated");
  expect_refused({"0", "1", "2", "none"}, path("none") + " cannot be read: No such file");
  expect_refused({"0", "1", "2", "none"}, path("2") + " is truncated");  // each is named at once
  expect_refused({"half", "0", "1"}, path("half") + " is one of 2 shards");
  EXPECT_TRUE(std::filesystem::exists(path("0"))) << "what is good is kept";
  for (const char* shard : {"17/16", "16/16", "-1/4", "1", "a/b", "1/2x", " 1/2", "+1/2"})
    EXPECT_NE(part(orbits, shard, "x").body.find("must be I/N"), std::string::npos) << shard;
}

}  // namespace
}  // namespace least::server::test
