// Maps requests to answers, and decides who may ask.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "server/http/admission.hpp"
#include "server/http/assets.hpp"
#include "server/http/effort.hpp"
#include "server/http/http_request.hpp"
#include "server/http/request_head.hpp"
#include "server/shared/answer.hpp"

namespace least::server {

/// Access is which browsers may use the service.
struct Access {
  std::vector<std::string> hosts;    ///< names accepted in `Host`, without port
  std::vector<std::string> origins;  ///< accepted foreign origins, such as `https://example.org`
  std::vector<std::string> frames;   ///< origins whose pages may embed the page in a frame
};

/// ErrorAnswer is how the service words an error; `detail` may be empty.
using ErrorAnswer = Answer (*)(int status, std::string_view detail, std::string_view request_id);

/// Hint returns help for a 404 or 405 of a path, as the continuation of a sentence; may be empty.
using Hint = std::function<std::string(int status, std::string_view path)>;

/// Glance estimates what reading a body takes from its beginning; `brief`: it will be refused.
using Glance = Effort (*)(std::string_view body);

/// Job computes the answer of a request that was read without faults, once there is a place for it. Its exceptions are
/// faults of the service.
using Job = std::function<Answer(Admission::Pass)>;
/// Prepared is a refusal, or the job.
using Prepared = std::variant<Answer, Job>;

/// Routed is an answer or a job, and the route that gave it.
struct Routed {
  Prepared outcome;
  std::string_view route;
};

/// Router holds all routes of the service.
class Router {
 public:
  using Prepare = std::function<Prepared(const HttpRequest&)>;
  using Probe = std::function<Answer(std::string_view request_id)>;

  Router(Access access, ErrorAnswer error);

  /// add_page adds a file of the page; `/index.html` is served at `/` as well.
  void add_page(const Asset& asset);
  /// add_text adds a text that is made once. It is always sent whole, never as 206, since a field `Range` may be
  /// ignored (RFC 9110, 14.2). A client that resumes at its end, as after a complete download, gets 416. `route` names
  /// all paths of this kind in the log; it must have static lifetime.
  void add_text(std::string path, std::string_view route, std::string_view type, std::string body);
  /// add_probe adds a GET about the service itself, answered anew each time. Any `Host` is accepted, as probes of an
  /// orchestrator use an address. `path` must have static lifetime.
  /// `apart`: it is served at the port for metrics only, and is all that is there.
  void add_probe(std::string_view path, Probe probe, bool apart = false);
  /// add_computed adds a POST that is computed for each request. `path` must have static lifetime. A body of more than
  /// 4 KiB that is not refused by the glance is read when its turn has come.
  void add_computed(std::string_view path, Prepare prepare);
  void add_hint(Hint hint);
  void add_glance(Glance glance);

  /// effort returns what answering a request takes before its turn to compute.
  Effort effort(const RequestHead& head, std::string_view body) const;
  /// is_short tells whether a request is answered within microseconds, so that it needs no worker thread.
  bool is_short(const RequestHead& head, Effort effort) const;
  /// The call operator answers a request, or returns its job; exceptions pass through.
  Routed operator()(const RequestHead& head, const HttpRequest& request) const;
  /// dress adds what goes with every answer of a route: its coding, and header fields.
  void dress(const RequestHead& head, std::string_view route, Answer& answer) const;

 private:
  struct Fixed {
    std::string_view route;
    std::string type, body, etag;
    bool page = false;  // has the content security policy of a page
    // The compressed body, made when it is first asked for.
    struct Packed {
      std::once_flag made;
      std::string body;
    };
    std::unique_ptr<Packed> packed = std::make_unique<Packed>();
  };

  void add_fixed(std::string path, std::string_view route, std::string_view type, std::string body, bool page);
  bool host_allowed(const RequestHead& head) const;
  Answer unknown_host(const RequestHead& head, std::string_view request_id) const;
  bool origin_allowed(const RequestHead& head) const;
  bool frame_refused(const RequestHead& head) const;
  Answer refused_frame(const RequestHead& head, std::string_view request_id) const;
  Prepared dispatch(const RequestHead& head, const HttpRequest& request, std::string_view& route) const;
  Answer fixed(const RequestHead& head, const Fixed& fixed, std::string_view request_id) const;

  Access access_;
  std::string page_policy_;  // the Content-Security-Policy of the page
  ErrorAnswer error_;
  Glance glance_ = [](std::string_view) { return Effort::reading; };
  Hint hint_ = [](int, std::string_view) { return std::string(); };
  std::map<std::string, Fixed> fixed_;  // answers made once, by path
  std::map<std::string_view, Prepare> computed_;
  struct ProbeAt {
    Probe answer;
    bool apart = false;
  };
  std::map<std::string_view, ProbeAt> probes_;
};

}  // namespace least::server
