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
  double grace = 10;            ///< seconds that computations have left when the server ends
  ConnectionBounds bounds;
  std::vector<std::string> allow_hosts, allow_origins;
};

class HttpServer {
 public:
  /// What clients send and what of its answer has not left counts in `memory`, where there is any, which lives on:
  /// beyond it the answer is 503; so does, beyond 64 KiB, the tree of a request that is being read. Not counted are 4
  /// KiB of each of them, and in the queue what is made of a short one, a quarter of a megabyte of recorded mechanics
  /// at most.
  ///
  /// An answer that is computed while it leaves holds its place while its client reads. One that reads nothing loses it
  /// after `stall`, one that drips after `drip`, see ConnectionBounds, or when the run's own `limits.seconds` are over.
  HttpServer(HttpSettings settings, ErrorAnswer error, MemoryBudget* memory = nullptr);
  ~HttpServer();  ///< stops
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  /// Takes routes until the start.
  Router& router();
  /// Where what computes gets its turn.
  Admission& admission();
  Metrics& metrics();
  /// No new clients are let in: it ends.
  bool draining() const;
  /// Set once computations are to end with what they have.
  const std::atomic<bool>& cancelled() const;

  /// Listens from now on. On failure: what went wrong, for a person.
  std::optional<std::string> start();

  /// `http://127.0.0.1:8080`
  std::string url() const;
  int port() const;
  /// False once the server no longer accepts connections.
  bool running() const;

  /// Ends: accepts nothing new, answers what was accepted; what still computes after the grace time is cancelled and
  /// answered with what it has. Returns when the last answer is out, a bounded time after the grace.
  void stop();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace least::server
