// Which request meets which answer, and who may ask.
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

/// Who may drive the service from a browser.
struct Access {
  std::vector<std::string> hosts;    ///< names accepted in `Host`, without port
  std::vector<std::string> origins;  ///< foreign origins accepted, such as `https://example.org`
  std::vector<std::string> frames;   ///< origins whose pages may hold the page in a frame
};

/// How the service words an error; `detail` may be empty.
using ErrorAnswer = Answer (*)(int status, std::string_view detail, std::string_view request_id);

/// What helps further beside a refusal, 404 or 405, of a path; begins as the rest of a sentence does, may be empty.
using Hint = std::function<std::string(int status, std::string_view path)>;

/// What it takes to read a body, from a glance at it; `brief`: it is refused.
using Glance = Effort (*)(std::string_view body);

/// What is left to compute of an answer when a request was read and found good, once there is a place for it. What it
/// throws is a fault of the service.
using Job = std::function<Answer(Admission::Pass)>;
/// A refusal, or the work.
using Prepared = std::variant<Answer, Job>;

/// An answer, or what makes it, and the route that gave it.
struct Routed {
  Prepared outcome;
  std::string_view route;
};

class Router {
 public:
  using Prepare = std::function<Prepared(const HttpRequest&)>;
  using Probe = std::function<Answer(std::string_view request_id)>;

  Router(Access access, ErrorAnswer error);

  /// A file of the page; `/index.html` stands at `/` as well.
  void add_page(const Asset& asset);
  /// A text that is made once. It is sent whole: no answer is 206, as a field `Range` may be ignored (RFC 9110, 14.2).
  /// Who goes on from its end, which a download that is whole already does, is told so by 416. `route` names all paths
  /// of its kind in the log and lives on.
  void add_text(std::string path, std::string_view route, std::string_view type, std::string body);
  /// GET: what the service is asked about itself, made anew each time. Any `Host` is answered: the probes of an
  /// orchestrator come with an address. `path` lives on.
  /// `apart`: it is asked by the port for metrics, and there is nothing else there.
  void add_probe(std::string_view path, Probe probe, bool apart = false);
  /// POST: computed for each request. `path` lives on. A body of more than 4 KiB that is not refused at a glance is
  /// read when its turn has come.
  void add_computed(std::string_view path, Prepare prepare);
  void add_hint(Hint hint);
  void add_glance(Glance glance);

  /// What it takes to answer a request, as far as its turn to compute.
  Effort effort(const RequestHead& head, std::string_view body) const;
  /// Whether it is answered within microseconds: it need not be handed to a thread that may take its time.
  bool is_short(const RequestHead& head, Effort effort) const;
  /// Answers a request, or says what is to be computed; throws what that throws.
  Routed operator()(const RequestHead& head, const HttpRequest& request) const;
  /// What goes with every answer of a route: its coding, and header fields.
  void dress(const RequestHead& head, std::string_view route, Answer& answer) const;

 private:
  struct Fixed {
    std::string_view route;
    std::string type, body, etag;
    bool page = false;  // carries the policy of a page
    // The body compressed, once somebody asks for it.
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
