// The built binary as a child process.
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace least::server::test {

// A child process with its standard streams.
class Process {
 public:
  /// `closed` is a descriptor that the process begins without; none where negative. `descriptors` limits how many it
  /// may open.
  explicit Process(std::vector<std::string> arguments, std::string_view input = "",
                   std::vector<std::string> environment = {}, int closed = -1, const rlimit* descriptors = nullptr) {
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
      if (closed >= 0) ::close(closed);
      ::signal(SIGHUP, SIG_DFL);  // also where the tests themselves ignore it
      if (descriptors) ::setrlimit(RLIMIT_NOFILE, descriptors);
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
  /// errors_until() returns the standard error up to the line that contains `part`; after ten seconds of silence what
  /// there is.
  std::string errors_until(std::string_view part) const {
    std::string text;
    pollfd ready{err_, POLLIN, 0};
    for (char c; ::poll(&ready, 1, 10'000) == 1 && ::read(err_, &c, 1) == 1;) {
      text += c;
      if (c == '\n' && text.find(part) != std::string::npos) break;
    }
    return text;
  }
  int id() const { return pid_; }
  /// processor_seconds() returns the processor time of all threads of the process so far.
  double processor_seconds() const {
    std::ifstream file("/proc/" + std::to_string(pid_) + "/stat");
    std::string words;
    std::getline(file, words, ')');  // the name may have spaces
    for (int field = 3; field < 14; ++field) file >> words;
    double user = 0, system = 0;
    file >> user >> system;
    return (user + system) / static_cast<double>(::sysconf(_SC_CLK_TCK));
  }
  /// least_seconds() calls act() up to three times, until it takes less than `most` seconds of the processor, and
  /// returns the least time: on a shared machine one call takes longer now and then, but a computation that is not
  /// bounded does so each time.
  template <class Act>
  double least_seconds(double most, Act&& act) const {
    double least = most;
    for (int attempt = 0; attempt < 3 && !(least < most); ++attempt) {
      const double before = processor_seconds();
      act();
      least = std::min(least, processor_seconds() - before);
    }
    return least;
  }
  void signal(int number) const { ::kill(pid_, number); }
  /// wait() returns the exit code; 128 + the signal where a signal ended the process.
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

/// port_in() returns the port that a service says it listens on.
inline int port_in(const std::string& line) { return std::stoi(line.substr(line.rfind(':') + 1)); }

}  // namespace least::server::test
