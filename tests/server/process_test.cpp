// The built binary: commands, exit codes, signals.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

#include "least_version.hpp"
#include "server/decode/json_parse.hpp"
#include "tests/server/client.hpp"

namespace least::server::test {
namespace {

using namespace std::chrono_literals;

// A child process with its standard streams.
class Process {
 public:
  explicit Process(std::vector<std::string> arguments, std::string_view input = "",
                   std::vector<std::string> environment = {}) {
    std::array<int, 2> in{}, out{}, err{};
    if (::pipe2(in.data(), O_CLOEXEC) || ::pipe2(out.data(), O_CLOEXEC) || ::pipe2(err.data(), O_CLOEXEC)) std::abort();
    arguments.insert(arguments.begin(), LEAST_BINARY);
    std::vector<char*> argv, envp;
    for (auto& argument : arguments) argv.push_back(argument.data());
    for (auto& variable : environment) envp.push_back(variable.data());
    argv.push_back(nullptr);
    envp.push_back(nullptr);
    pid_ = ::fork();
    if (pid_ == 0) {
      ::dup2(in[0], 0);
      ::dup2(out[1], 1);
      ::dup2(err[1], 2);
      ::execve(argv[0], argv.data(), envp.data());
      ::_exit(127);
    }
    ::close(in[0]);
    ::close(out[1]);
    ::close(err[1]);
    if (::write(in[1], input.data(), input.size()) < 0) std::abort();
    ::close(in[1]);
    out_ = out[0];
    err_ = err[0];
  }
  ~Process() {
    if (pid_ > 0) {
      ::kill(pid_, SIGKILL);
      wait();
    }
    ::close(out_);
    ::close(err_);
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  std::string line() const {
    std::string text;
    for (char c; ::read(out_, &c, 1) == 1 && c != '\n';) text += c;
    return text;
  }
  std::string output() const { return all(out_); }
  std::string errors() const { return all(err_); }
  void signal(int number) const { ::kill(pid_, number); }
  /// The exit code; 128 + the signal where one ended it.
  int wait() {
    int status = 0;
    ::waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

 private:
  static std::string all(int descriptor) {
    std::string text;
    char bytes[65536];
    for (ssize_t n; (n = ::read(descriptor, bytes, sizeof bytes)) > 0;) text.append(bytes, static_cast<std::size_t>(n));
    return text;
  }
  pid_t pid_ = -1;
  int out_ = -1, err_ = -1;
};

int port_in(const std::string& line) { return std::stoi(line.substr(line.rfind(':') + 1)); }

const std::string kepler_run = R"({"problem":"kepler","scheme":"leapfrog","until":{"t":1}})";

TEST(Command, RunAnswersAsHttpWould) {
  Process run({"run", "-"}, kepler_run);
  const Json json = Json::parse(run.output());
  EXPECT_EQ(json["status"], "completed");
  EXPECT_EQ(run.errors(), "");
  EXPECT_EQ(run.wait(), 0);

  const std::string file = testing::TempDir() + "least_request.json";
  std::ofstream(file) << kepler_run;
  Process from_file({"run", file});
  Json again = Json::parse(from_file.output()), first = json;
  again.erase("cost");
  first.erase("cost");
  EXPECT_EQ(again.dump(), first.dump());
  EXPECT_EQ(from_file.wait(), 0);
  std::filesystem::remove(file);
}

TEST(Command, RunSaysWhatIsWrong) {
  Process faulty({"run", "-"}, R"({"problem":"kepler"})");
  EXPECT_EQ(Json::parse(faulty.output())["status"], 422);
  EXPECT_EQ(faulty.wait(), 2);
  Process broken({"run", "-"}, "{");
  EXPECT_EQ(Json::parse(broken.output())["status"], 400);
  EXPECT_EQ(broken.wait(), 2);
  Process nothing({"run", "/nonexistent/request.json"});
  const Json document = Json::parse(nothing.output());
  EXPECT_EQ(document["status"], 400);
  EXPECT_NE(document["detail"].get<std::string>().find("/nonexistent/request.json"), std::string::npos);
  EXPECT_EQ(nothing.wait(), 2);
  Process folder({"run", "/"});
  EXPECT_EQ(Json::parse(folder.output())["status"], 400);
  EXPECT_EQ(folder.wait(), 2);
}

TEST(Command, CatalogueVersionAndHelp) {
  Process catalogue({"catalogue"});
  const Json cards = Json::parse(catalogue.output());
  EXPECT_FALSE(cards["schemes"].empty());
  EXPECT_EQ(catalogue.wait(), 0);
  for (const Json& problem : cards["problems"]) {
    if (problem["id"] != "kepler") continue;
    std::vector<std::string> invariants;
    for (const Json& invariant : problem["invariants"]) invariants.push_back(invariant["name"]);
    EXPECT_EQ(invariants,
              (std::vector<std::string>{"energy", "angular_momentum", "laplace_runge_lenz_x", "laplace_runge_lenz_y"}));
  }
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"--version"},
                                                    {"serve", "--version"},
                                                    {"run", "--version"},
                                                    {"catalogue", "--version"}}) {
    Process version(arguments);
    EXPECT_EQ(version.output(), "leastaction " + std::string(least::version) + "\n");
    EXPECT_EQ(version.wait(), 0);
  }
  Process help({"serve", "--help"});
  EXPECT_NE(help.output().find("LEASTACTION_PORT"), std::string::npos);
  EXPECT_EQ(help.wait(), 0);
  Process mistake({"serve", "--prot", "1"});
  EXPECT_NE(mistake.errors(), "");
  EXPECT_EQ(mistake.wait(), 1);
}

TEST(Command, OptionsComeFromTheEnvironment) {
  Process run({"run", "-"}, R"({"problem":"kepler","scheme":"leapfrog","limits":{"seconds":2}})",
              {"LEASTACTION_MAX_SECONDS=1"});
  EXPECT_EQ(Json::parse(run.output())["errors"][0]["allowed"], "(0, 1]");
  EXPECT_EQ(run.wait(), 2);
}

TEST(Command, ServeSaysWhereAndLogsEachRequest) {
  Process serve({"serve", "--port", "0"});
  const std::string line = serve.line();
  EXPECT_EQ(line.find("listening on http://127.0.0.1:"), 0u) << line;
  EXPECT_EQ(ask(port_in(line), get("/")).status, 200);
  const Reply reply = ask(port_in(line), post("/v1/simulate", kepler_run));
  EXPECT_EQ(reply.status, 200);
  serve.signal(SIGINT);
  EXPECT_EQ(serve.output(), "");
  const std::string log = serve.errors();
  EXPECT_NE(log.find("id=" + reply.fields.at("x-request-id") + " method=POST route=/v1/simulate status=200 ms="),
            std::string::npos)
      << log;
  EXPECT_EQ(serve.wait(), 0);
}

TEST(Command, APortInUseIsAnError) {
  Process first({"serve", "--port", "0"});
  const std::string line = first.line();
  Process second({"serve", "--port", std::to_string(port_in(line))});
  EXPECT_EQ(second.output(), "");
  EXPECT_NE(second.errors().find("Address already in use"), std::string::npos);
  EXPECT_EQ(second.wait(), 1);
  first.signal(SIGTERM);
  EXPECT_EQ(first.wait(), 0);
  Process third({"serve", "--port", std::to_string(port_in(line))});  // free again at once
  EXPECT_EQ(third.line(), line);
}

TEST(Command, TerminationAnswersWhatWasAccepted) {
  Process serve({"serve", "--port", "0", "--grace", "0.3"});
  const int port = port_in(serve.line());
  Client running(port);
  running.send(post("/v1/simulate", R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":10000000000},
    "record":{"every":0},"limits":{"steps":10000000000,"seconds":60}})"));
  std::this_thread::sleep_for(300ms);
  serve.signal(SIGTERM);
  const auto reply = running.receive();
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->status, 200);
  EXPECT_EQ(Json::parse(reply->body)["stop"]["reason"], "cancelled");
  EXPECT_EQ(serve.wait(), 0);
}

}  // namespace
}  // namespace least::server::test
