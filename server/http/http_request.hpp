// HttpRequest is a request to an endpoint that computes.
#pragma once

#include <functional>
#include <string_view>

namespace least::server {

/// `accept` must live until the request has been read; the other texts until the answer has been sent.
struct HttpRequest {
  std::string_view body, accept, id;
  std::function<bool()> gone{};  ///< whether the client is gone; empty: it never is
  std::string_view client{};     ///< its address
  bool for_metrics = false;      ///< received at the port for metrics
};

}  // namespace least::server
