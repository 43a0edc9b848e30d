// Clients that ask without a pause, each on a connection of its own, and one that asks beside them.
#pragma once

#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "tests/server/client.hpp"

namespace least::server::test {

/// They ask until the crowd is destroyed, or their connections end.
class Crowd {
 public:
  Crowd(int port, int clients, std::string request) : request_(std::move(request)) {
    for (int i = 0; i < clients; ++i) threads_.emplace_back([this, port] { ask_on(Client(port)); });
  }
  Crowd(const Crowd&) = delete;
  ~Crowd() { end_ = true; }

  /// How many of their requests were computed so far.
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
  std::vector<std::jthread> threads_;  // last: they end before what they use
};

/// How many of so many small runs, asked for one after the other on this connection, are computed.
inline int served_of(int asked, Client client) {
  int served = 0;
  for (int i = 0; i < asked; ++i) {
    client.send(post("/v1/simulate", R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":10}})"));
    served += client.receive().value_or(Reply{}).status == 200 ? 1 : 0;
  }
  return served;
}

}  // namespace least::server::test
