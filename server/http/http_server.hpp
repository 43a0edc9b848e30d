// The HTTP server: one loop for all connections and threads for what takes its time; routes and logs what comes, ends
// in good order. As many threads as compute at once, one for short answers, one for the loop.
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
  unsigned threads = 0;         ///< requests that compute at once; 0: one per core
  unsigned queue = 256;         ///< requests that wait for their turn; beyond it the answer is 503
  unsigned connections = 8192;  ///< at once; beyond it, or where descriptors run out, those that idle make room
  int metrics_port = -1;        ///< where /metrics is; negative: at `port`
  double drain = 0;             ///< seconds that the port stays open when the server ends
  double grace = 10;            ///< seconds that computations have left when the server ends
  bool alone = false;           ///< nothing else is in the memory of the process: its bytes are looked at, too
  ConnectionBounds bounds;
  std::vector<std::string> allow_hosts, allow_origins;
  std::vector<std::string> allow_frames;     ///< origins of pages that may hold this one in a frame
  std::vector<std::string> trusted_proxies;  ///< addresses that say the truth about their clients
};

class HttpServer {
 public:
  /// What clients send and what of its answer has not left counts in `memory`, where there is any, which lives on:
  /// beyond it the answer is 503; so does, beyond 64 KiB, the tree of a request that is being read. Not counted are 4
  /// KiB of each of them, and in the queue what is made of a short one, a quarter of a megabyte of recorded mechanics
  /// at most.
  ///
  /// An answer that is computed while it leaves lends its place to others while its client is behind, for at most
  /// Workers::most_aside of them; a further one ends. A client that reads nothing is let go after `stall`, one that
  /// drips after `drip`, see ConnectionBounds, and the run ends when its own `limits.seconds` are over.
  HttpServer(HttpSettings settings, ErrorAnswer error, MemoryBudget* memory = nullptr);
  ~HttpServer();  ///< stops
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  /// Takes routes until the start.
  Router& router();
  /// Where what computes gets its turn.
  Admission& admission();
  const Admission& admission() const;
  Metrics& metrics();
  /// It is about to end.
  bool leaving() const;
  std::size_t connections() const;
  const HttpSettings& settings() const;
  int metrics_port() const;
  /// Set once computations are to end with what they have.
  const std::atomic<bool>& cancelled() const;

  /// Listens from now on. On failure: what went wrong, for a person.
  std::optional<std::string> start();

  /// `http://127.0.0.1:8080`
  std::string url() const;
  int port() const;
  /// False once the server no longer accepts connections.
  bool running() const;

  /// Ends: serves for as long as it drains, then accepts nothing new, answers what was accepted; what still computes
  /// after the grace time is cancelled and answered with what it has. Returns when the last answer is out, a bounded
  /// time after the grace.
  void stop();
  /// Ends the time for which it drains, if it does. From any thread.
  void hurry();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace least::server
