// The HTTP server: one loop for all connections and threads for long tasks; it routes and logs requests, and shuts down
// in order. It has as many threads as computations at once, one for short answers, and one for the loop.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/http/admission.hpp"
#include "server/http/connection.hpp"
#include "server/http/metrics.hpp"
#include "server/http/router.hpp"

namespace least::server {

struct HttpSettings {
  std::string host = "127.0.0.1";
  int port = 8080;              ///< 0 picks a free one
  unsigned threads = 0;         ///< computations at once; 0: one per core
  unsigned queue = 256;         ///< requests that wait for their turn; further ones are answered 503
  unsigned connections = 8192;  ///< limit of connections; beyond it, or without descriptors, idle ones are closed
  int metrics_port = -1;        ///< the port of /metrics; negative: `port`
  double drain = 0;             ///< seconds that the port stays open while the server ends
  double grace = 10;            ///< seconds that computations have left while the server ends
  bool alone = false;           ///< nothing else runs in this process: its resident memory is watched, too
  ConnectionBounds bounds;
  std::vector<std::string> allow_hosts, allow_origins;
  std::vector<std::string> allow_frames;     ///< origins of pages that may embed this one in a frame
  std::vector<std::string> trusted_proxies;  ///< addresses whose X-Forwarded-For is believed
};

/// HttpServer runs from start() to stop().
class HttpServer {
 public:
  /// Requests and unsent answers are charged to `memory`, if given, which must outlive the server; beyond it the answer
  /// is 503. Trees of requests above 64 KiB are charged as well. Not charged are 4 KiB of each request, and, in the
  /// queue, what is made of a short request, at most a quarter of a megabyte of recorded mechanics.
  ///
  /// An answer that is computed while it is sent lends its place to others while its client is behind, at most
  /// Workers::most_aside answers at once; a further one ends. A client that reads nothing is disconnected after
  /// `stall`, one that reads too slowly after `drip`, see ConnectionBounds, and the run ends when its own
  /// `limits.seconds` are over.
  HttpServer(HttpSettings settings, ErrorAnswer error, MemoryBudget* memory = nullptr);
  ~HttpServer();  ///< stops
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  /// Accepts routes until start().
  Router& router();
  /// Gives turns to what computes.
  Admission& admission();
  const Admission& admission() const;
  Metrics& metrics();
  /// The server is about to end.
  bool leaving() const;
  std::size_t connections() const;
  const HttpSettings& settings() const;
  int metrics_port() const;
  /// Set once computations are to end with what they have.
  const std::atomic<bool>& cancelled() const;

  /// start() begins to listen. Returns an error message, or nothing.
  std::optional<std::string> start();

  /// `http://127.0.0.1:8080`
  std::string url() const;
  int port() const;
  /// False once the server accepts no connections any more.
  bool running() const;

  /// stop() ends the server: it serves on while it drains, then accepts nothing new and answers what was received;
  /// computations that still run after the grace time are cancelled and answered with what they have. Returns when the
  /// last answer is sent, a bounded time after the grace.
  void stop();
  /// hurry() ends the drain time. From any thread.
  void hurry();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace least::server
