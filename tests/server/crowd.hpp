// Clients that ask without a pause, each on a connection of its own, and one client beside them.
#pragma once

#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "tests/server/client.hpp"

namespace least::server::test {

/// Crowd asks until it is destroyed, or its connections end.
class Crowd {
 public:
  Crowd(int port, int clients, std::string request) : request_(std::move(request)) {
    for (int i = 0; i < clients; ++i) threads_.emplace_back([this, port] { ask_on(Client(port)); });
  }
  Crowd(const Crowd&) = delete;
  ~Crowd() { end_ = true; }

  /// answered() returns how many of its requests were answered with 200 so far.
  int answered() const { return answered_; }

 private:
  void ask_on(Client client) {
    while (!end_ && client.send(request_)) {
      const auto reply = client.receive();
      if (!reply) return;
      answered_ += reply->status == 200 ? 1 : 0;
    }
  }

  const std::string request_;
  std::atomic<bool> end_{false};
  std::atomic<int> answered_{0};
  std::vector<std::jthread> threads_;  // last: the threads end before what they use
};

/// served_of() makes `asked` small requests one after the other on this connection and returns how many are answered
/// with 200.
inline int served_of(int asked, Client client) {
  int served = 0;
  for (int i = 0; i < asked; ++i) {
    client.send(post("/v1/simulate", R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":10}})"));
    served += client.receive().value_or(Reply{}).status == 200 ? 1 : 0;
  }
  return served;
}

}  // namespace least::server::test
