// The listening socket and the threads of the connections: all that is used of cpp-httplib.
//
// Reading requests and writing answers is not left to the library: the release in Debian 12 cannot close a connection
// whose request it refused (what is left of the body would be read as the next request), keeps headers and chunked
// bodies without bound, and believes contradictory lengths.
#pragma once

#include <httplib.h>

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace least::server {

class Listener final : private httplib::Server {
 public:
  /// `serve` is called on a thread of its own for each connection; the socket is closed after it. `waiting` counts
  /// connections that no thread has taken up yet.
  Listener(std::size_t threads, std::atomic<int>& waiting, std::function<void(int)> serve);

  /// Binds and starts to queue connections. On failure: why, in the system's words.
  std::optional<std::string> bind(const std::string& host, int port);
  int port() const { return port_; }

  /// Accepts connections until `close`; returns when all of them are served.
  void listen() { listen_after_bind(); }

  /// Accepts no more. Safe from any thread, also before `listen`.
  void close();

 private:
  bool process_and_close_socket(socket_t socket) override;

  std::function<void(int)> serve_;
  std::unique_ptr<httplib::TaskQueue> pool_;  // until the library takes it over
  int socket_ = -1, port_ = 0;
};

}  // namespace least::server
