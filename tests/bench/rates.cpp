// Requests a second on eight connections in a closed loop, compared with a server on bare sockets that parses and
// computes nothing and always sends the same short answer.
#include <arpa/inet.h>
#include <benchmark/benchmark.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <spdlog/spdlog.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "server/service.hpp"
#include "tests/bench/table.hpp"

namespace {

using namespace least;

constexpr std::string_view hello = "GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n";

sockaddr_in loopback(int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

// Sockets owns sockets and waits for events on them.
class Sockets {
 public:
  Sockets() = default;
  ~Sockets() {
    for (const int socket : all_) ::close(socket);
    ::close(epoll_);
  }
  Sockets(const Sockets&) = delete;
  Sockets& operator=(const Sockets&) = delete;

  void add(int socket) {
    const int yes = 1;
    ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    epoll_event event{EPOLLIN, {}};
    event.data.fd = socket;
    ::epoll_ctl(epoll_, EPOLL_CTL_ADD, socket, &event);
    all_.push_back(socket);
  }
  // answer() waits up to 100 ms and sends `text` on every socket that has received something. It returns the number of
  // these sockets, or -1 where a connection is closed.
  int answer(std::string_view text) {
    const int n = ::epoll_wait(epoll_, events_.data(), static_cast<int>(events_.size()), 100);
    for (int i = 0; i < n; ++i) {
      const int socket = events_[static_cast<std::size_t>(i)].data.fd;
      char bytes[16384];
      if (::recv(socket, bytes, sizeof bytes, 0) <= 0) return -1;
      if (::send(socket, text.data(), text.size(), MSG_NOSIGNAL) < 0) return -1;
    }
    return n;
  }
  const std::vector<int>& all() const { return all_; }

 private:
  int epoll_ = ::epoll_create1(EPOLL_CLOEXEC);
  std::vector<int> all_;
  std::array<epoll_event, 64> events_{};
};

// Bare is the bare server that ours is measured against.
class Bare {
 public:
  Bare() {
    sockaddr_in address = loopback(0);
    socklen_t size = sizeof address;
    ::bind(listener_, reinterpret_cast<sockaddr*>(&address), size);
    ::listen(listener_, SOMAXCONN);
    ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
    thread_ = std::jthread([this](const std::stop_token& stop) {
      Sockets sockets;
      for (int i = 0; i < 8; ++i) sockets.add(::accept(listener_, nullptr, nullptr));
      constexpr std::string_view text =
          "HTTP/1.1 200 OK\r\nContent-Type: application/json\r\nContent-Length: 16\r\n\r\n{\"status\":\"ok\"}\n";
      while (!stop.stop_requested() && sockets.answer(text) >= 0) {
      }
    });
  }
  ~Bare() { ::close(listener_); }
  int port() const { return port_; }

 private:
  int listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  int port_ = 0;
  std::jthread thread_;
};

// One iteration waits for about a thousand answers.
void ask_on_and_on(benchmark::State& state, int port, std::string_view request) {
  Sockets sockets;
  const sockaddr_in address = loopback(port);
  for (int i = 0; i < 8; ++i) {
    const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      return state.SkipWithError("no connection");
    }
    sockets.add(socket);
    ::send(socket, request.data(), request.size(), MSG_NOSIGNAL);
  }
  constexpr int answers = 1000;
  for (auto _ : state) {
    for (int n = 0; n < answers;) {
      const int more = sockets.answer(request);
      if (more <= 0) return state.SkipWithError("no answer");
      n += more;
    }
  }
  state.counters["units"] = answers;
}

void bare(benchmark::State& state) {
  const Bare server;
  ask_on_and_on(state, server.port(), hello);
}

void ours(benchmark::State& state, std::string_view request) {
  spdlog::set_level(spdlog::level::off);  // the standard output is for the results
  server::Settings settings;
  settings.port = 0;
  server::Service service(settings, {});
  if (service.start()) return state.SkipWithError("the service does not start");
  ask_on_and_on(state, service.port(), request);
}

void health(benchmark::State& state) { ours(state, hello); }

std::string simulate(const std::string& body) {
  return "POST /v1/simulate HTTP/1.1\r\nHost: localhost\r\nContent-Length: " + std::to_string(body.size()) +
         "\r\n\r\n" + body;
}

// Everything but a run and its answer: the request is read and refused.
void no_run(benchmark::State& state) {
  ours(state, simulate(R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":0}})"));
}

void tiny_run(benchmark::State& state) {
  ours(state, simulate(R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":10}})"));
}

const bool registered = [] {
  benchmark::RegisterBenchmark("rate/bare", bare)->Unit(benchmark::kMillisecond)->UseRealTime();
  benchmark::RegisterBenchmark("rate/health", health)->Unit(benchmark::kMillisecond)->UseRealTime();
  benchmark::RegisterBenchmark("rate/no_run", no_run)->Unit(benchmark::kMillisecond)->UseRealTime();
  benchmark::RegisterBenchmark("rate/run", tiny_run)->Unit(benchmark::kMillisecond)->UseRealTime();
  bench::compare("/healthz on 8 connections; a server on bare sockets", "rate/health", "rate/bare", 1 / 0.55);
  bench::compare("… a request that is read and refused; the same", "rate/no_run", "rate/bare", 0);
  bench::compare("… a run of ten steps; the same", "rate/run", "rate/bare", 0);
  return true;
}();

}  // namespace
