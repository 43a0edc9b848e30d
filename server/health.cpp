#include "server/health.hpp"

#include <fmt/format.h>
#include <httplib.h>

namespace least::server {

std::optional<std::string> health_fault(const std::string& host, int port) {
  constexpr int patience = 2;  // seconds
  httplib::Client client(host, port);
  client.set_connection_timeout(patience);
  client.set_read_timeout(patience);
  const auto answer = client.Get("/healthz");
  if (!answer) return fmt::format("no answer from {} port {}: {}", host, port, httplib::to_string(answer.error()));
  if (answer->status != 200) return fmt::format("{} port {} answers {}", host, port, answer->status);
  return std::nullopt;
}

}  // namespace least::server
