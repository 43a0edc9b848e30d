// Asks a service whether it is alive, for the health check of a container.
#pragma once

#include <optional>
#include <string>

namespace least::server {

/// health_fault returns nothing where GET /healthz answers 200, else why not.
std::optional<std::string> health_fault(const std::string& host, int port);

}  // namespace least::server
