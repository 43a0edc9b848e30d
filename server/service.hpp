// The service: listens, gives every connection a thread, ends in good order.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/decode/simulate_request.hpp"
#include "server/http/assets.hpp"
#include "server/http/connection.hpp"

namespace least::server {

struct Settings {
  std::string host = "127.0.0.1";
  int port = 8080;             ///< 0 picks a free one
  unsigned threads = 0;        ///< runs that compute at once; 0: one per core
  unsigned queue = 16;         ///< runs that wait for their turn; beyond it the answer is 503
  unsigned connections = 256;  ///< clients served at once, slow ones included
  double grace = 10;           ///< seconds that runs have left when the service ends
  Caps caps;
  ConnectionBounds bounds;
  std::vector<std::string> allow_hosts, allow_origins;
};

class Service {
 public:
  Service(Settings settings, std::span<const Asset> assets);
  ~Service();  ///< stops
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;

  /// Listens from now on. On failure: what went wrong, for a person.
  std::optional<std::string> start();

  /// `http://127.0.0.1:8080`
  std::string url() const;
  int port() const;
  /// False once the service no longer accepts connections.
  bool running() const;

  /// Ends: accepts nothing new, answers what was accepted; runs that still compute after the grace time are cancelled
  /// and answered with what they have. Returns when the last answer is out, a bounded time after the grace.
  void stop();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace least::server
