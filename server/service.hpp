// The service: the catalogue's endpoints behind an HTTP server.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "server/endpoint.hpp"
#include "server/http/http_server.hpp"

namespace least::server {

struct Settings : HttpSettings {
  Caps caps;
  std::size_t max_memory = std::size_t{1} << 30;  ///< for requests and answers, see memory_for
};

/// memory_for returns the bytes that requests and answers may hold: those of the settings, and in any case enough for
/// the largest answer.
std::size_t memory_for(const Settings& settings);

/// Service owns the HTTP server with all endpoints, and the memory budget of its requests.
class Service {
 public:
  Service(const Settings& settings, std::span<const Asset> assets);
  ~Service() { stop(); }

  /// As HttpServer::start(), and likewise below.
  std::optional<std::string> start() { return http_.start(); }
  std::string url() const { return http_.url(); }
  int port() const { return http_.port(); }
  int metrics_port() const { return http_.metrics_port(); }
  unsigned places() const { return http_.admission().places(); }
  std::size_t max_memory() const { return memory_.most(); }
  bool running() const { return http_.running(); }
  void stop() { http_.stop(); }
  void hurry() { http_.hurry(); }

 private:
  /// add_probes adds the health, readiness and metrics endpoints.
  void add_probes(Router& router);

  MemoryBudget memory_;
  HttpServer http_;
  const Context context_;
};

}  // namespace least::server
