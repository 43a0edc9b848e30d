// server/deploy: each file is valid for its reader, and names existing options and metrics.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "tests/server/client.hpp"
#include "tests/server/ensembles.hpp"
#include "tests/server/fixture.hpp"
#include "tests/server/process.hpp"
#include "tests/server/temporary_folder.hpp"

namespace least::server::test {
namespace {

const std::string folder = LEAST_SOURCE_DIR "/server/deploy/";

std::string text_of(const std::string& name) {
  std::ifstream file(folder + name);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  EXPECT_FALSE(text.empty()) << name;
  return text;
}

// said_by() returns what a program says against a file; empty where this machine does not have the program.
std::string said_by(const std::string& program, const std::string& command) {
  if (std::system(("command -v " + program + " >/dev/null").c_str()) != 0) return "";
  const std::string out = testing::TempDir() + "least_deploy.out";
  const int code = std::system((command + " >" + out + " 2>&1").c_str());
  std::ifstream file(out);
  const std::string said{std::istreambuf_iterator<char>(file), {}};
  std::filesystem::remove(out);
  return code == 0 ? "" : "failed: " + said;
}

TEST(Deploy, FilesAreWhatTheirReadersTake) {
  EXPECT_EQ(said_by("haproxy", "haproxy -c -f " + folder + "haproxy.cfg"), "");
  EXPECT_EQ(said_by("promtool", "promtool check rules " + folder + "alerts.yaml"), "");
  // The unit as it is installed, except for the binary.
  const std::string unit = testing::TempDir() + "leastaction.service";
  std::ofstream(unit) << std::regex_replace(text_of("leastaction.service"), std::regex("/usr/local/bin/leastaction"),
                                            LEAST_BINARY);
  EXPECT_EQ(said_by("systemd-analyze", "systemd-analyze verify --man=no " + unit), "");
  std::filesystem::remove(unit);
}

// arguments_of() returns the arguments that the manifests give to a command.
std::vector<std::string> arguments_of(const std::string& command) {
  const std::string text = text_of("kubernetes.yaml");
  const auto from = text.find("args: [" + command + ", ") + 7;
  const std::string list = text.substr(from, text.find(']', from) - from);
  const std::regex word("[^,\\s\"]+");
  return {std::sregex_token_iterator(list.begin(), list.end(), word), {}};
}

TEST(Deploy, TheManifestsStartAService) {
  std::vector<std::string> arguments = arguments_of("serve");
  ASSERT_GT(arguments.size(), 8U);
  *(std::ranges::find(arguments, "--metrics-port") + 1) = "0";
  for (const char* more : {"--port", "0", "--drain=0"}) arguments.emplace_back(more);
  std::erase(arguments, "--drain");
  std::erase(arguments, "5");
  Process serve(arguments);
  const std::string line = serve.line();
  ASSERT_NE(line.find("listening on"), std::string::npos) << serve.errors();
  EXPECT_EQ(ask(port_in(line), "GET /v1 HTTP/1.1\r\nHost: leastaction\r\n\r\n").status, 200)
      << "as the Service is called";
  serve.signal(SIGTERM);
  EXPECT_EQ(serve.wait(), 0);
}

// A shard has a limit of its memory that leaves the program half of what its container has.
TEST(Deploy, TheManifestsComputeAShard) {
  const TemporaryFolder parts;
  std::ofstream(parts.path("study.json")) << orbits;
  std::vector<std::string> arguments = arguments_of("ensemble");
  ASSERT_GT(arguments.size(), 8U);
  for (std::string& argument : arguments) {
    argument = std::regex_replace(argument, std::regex("\\$\\(JOB_COMPLETION_INDEX\\)"), "0");
    argument = std::regex_replace(argument, std::regex("^/(study|parts)/"), parts.path(""));
  }
  EXPECT_EQ(*(std::ranges::find(arguments, "--max-memory") + 1), "512M");
  Process shard(arguments);
  EXPECT_EQ(shard.output(), parts.path("part.0") + ": 1 blocks\n");
  EXPECT_EQ(shard.errors(), "");
  EXPECT_EQ(shard.wait(), 0);
}

// Variables in the unit and options in the comments are those of the program.
TEST(Deploy, OptionsAreThoseOfTheProgram) {
  Process help({"serve", "--help"});
  const std::string known = help.output();
  EXPECT_EQ(help.wait(), 0);
  const std::regex option("LEASTACTION_[A-Z_]+|--(?:allow|drain|grace|max|metrics|trusted|threads|host|port)[a-z-]*");
  std::set<std::string> found;
  for (const char* name : {"leastaction.service", "haproxy.cfg", "alerts.yaml"}) {
    const std::string text = text_of(name);
    for (std::sregex_iterator it(text.begin(), text.end(), option), end; it != end; ++it) found.insert(it->str());
  }
  EXPECT_GE(found.size(), 6U);
  for (const std::string& name : found) EXPECT_NE(known.find(name), std::string::npos) << name;
}

TEST(Deploy, AlertsSpeakOfMetricsThatThereAre) {
  Service service(quiet_settings(), page_assets);
  ASSERT_FALSE(service.start());
  const std::string rules = text_of("alerts.yaml"), metrics = ask(service.port(), get("/metrics")).body;
  const std::regex name("\\bleastaction_[a-z_]+");
  std::size_t found = 0;
  for (std::sregex_iterator it(rules.begin(), rules.end(), name), end; it != end; ++it, ++found) {
    const std::string kind = std::regex_replace(it->str(), std::regex("_bucket$"), "");
    EXPECT_NE(metrics.find("# TYPE " + kind + " "), std::string::npos) << kind;
  }
  EXPECT_GE(found, 7U);
}

}  // namespace
}  // namespace least::server::test
