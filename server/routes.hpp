// What the service answers: which request meets which endpoint, and who may ask.
#pragma once

#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/endpoint.hpp"
#include "server/http/answer.hpp"
#include "server/http/assets.hpp"
#include "server/http/request_head.hpp"

namespace least::server {

/// Who may drive the service from a browser.
struct Access {
  std::vector<std::string> hosts;    ///< names accepted in `Host`, without port
  std::vector<std::string> origins;  ///< foreign origins accepted, such as `https://example.org`
};

/// An answer and the route that gave it, for the log.
struct Routed {
  Answer answer;
  std::string_view route;
};

class Routes {
 public:
  Routes(const Context& context, Access access, std::span<const Asset> assets);

  /// Answers one request; throws what the endpoint throws. `gone`: whether the client went away.
  Routed operator()(const Head& head, std::string_view body, std::string_view request_id,
                    const std::function<bool()>& gone) const;

 private:
  struct Fixed {
    std::string_view route;
    std::string type, body, etag;
    bool page = false;  // carries the policy of a page
  };

  bool host_allowed(const Head& head) const;
  bool origin_allowed(const Head& head) const;
  Answer dispatch(const Head& head, const Question& question, std::string_view& route) const;
  Answer fixed(const Head& head, const Fixed& fixed, std::string_view request_id) const;

  const Context& context_;
  Access access_;
  std::map<std::string, Fixed> fixed_;  // answers made once, by path
};

}  // namespace least::server
