// What is asked of an endpoint that computes.
#pragma once

#include <functional>
#include <string_view>

namespace least::server {

/// Of the texts only `id` is needed while an answer streams; all outlive it.
struct HttpRequest {
  std::string_view body, accept, id;
  std::function<bool()> gone{};      ///< whether the client went away; empty: it never does
  std::string_view client{};         ///< its address
  double* seconds_queued = nullptr;  ///< where to say how long the request waited for its turn; may be null
};

}  // namespace least::server
