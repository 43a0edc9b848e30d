// Which request meets which answer, and who may ask.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "server/http/assets.hpp"
#include "server/http/http_request.hpp"
#include "server/http/request_head.hpp"
#include "server/shared/answer.hpp"

namespace least::server {

/// Who may drive the service from a browser.
struct Access {
  std::vector<std::string> hosts;    ///< names accepted in `Host`, without port
  std::vector<std::string> origins;  ///< foreign origins accepted, such as `https://example.org`
};

/// How the service words an error; `detail` may be empty.
using ErrorAnswer = Answer (*)(int status, std::string_view detail, std::string_view request_id);

/// An answer and the route that gave it, for the log.
struct Routed {
  Answer answer;
  std::string_view route;
};

class Router {
 public:
  using Compute = std::function<Answer(const HttpRequest&)>;

  Router(Access access, ErrorAnswer error);

  /// A file of the page; `/index.html` stands at `/` as well.
  void add_page(const Asset& asset);
  /// A text that is made once. `route` names all paths of its kind in the log and lives on.
  void add_text(std::string path, std::string_view route, std::string_view type, std::string body);
  /// POST: computed for each request. `path` lives on.
  void add_computed(std::string_view path, Compute compute);

  /// Answers one request; throws what computing throws. `gone`: whether the client went away.
  Routed operator()(const RequestHead& head, std::string_view body, std::string_view request_id,
                    const std::function<bool()>& gone) const;

 private:
  struct Fixed {
    std::string_view route;
    std::string type, body, etag;
    bool page = false;  // carries the policy of a page
  };

  void add_fixed(std::string path, std::string_view route, std::string_view type, std::string body, bool page);
  bool host_allowed(const RequestHead& head) const;
  bool origin_allowed(const RequestHead& head) const;
  Answer dispatch(const RequestHead& head, const HttpRequest& request, std::string_view& route) const;
  Answer fixed(const RequestHead& head, const Fixed& fixed, std::string_view request_id) const;

  Access access_;
  ErrorAnswer error_;
  std::map<std::string, Fixed> fixed_;  // answers made once, by path
  std::map<std::string_view, Compute> computed_;
};

}  // namespace least::server
