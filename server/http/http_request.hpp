// What is asked of an endpoint that computes.
#pragma once

#include <functional>
#include <string_view>

namespace least::server {

/// `accept` is needed until the request was read; the other texts live until the answer has left.
struct HttpRequest {
  std::string_view body, accept, id;
  std::function<bool()> gone{};  ///< whether the client went away; empty: it never does
  std::string_view client{};     ///< its address
  bool for_metrics = false;      ///< it came by the port for them
};

}  // namespace least::server
