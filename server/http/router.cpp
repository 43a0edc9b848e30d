#include "server/http/router.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>

#include "server/http/accept.hpp"
#include "server/http/gzip.hpp"

namespace least::server {
namespace {

// A body up to this size is read as soon as it has arrived, so that its faults are reported at once. This takes some
// milliseconds for a scene given as text, else some tens of microseconds.
constexpr std::size_t soon_read = 4096;

// tag returns an entity tag, by FNV-1a. It distinguishes versions; it is no protection.
std::string tag(std::string_view body) {
  std::uint64_t hash = 14695981039346656037u;
  for (const char c : body) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211u;
  return fmt::format("\"{:016x}\"", hash);
}

// without_port returns `localhost` for `LocalHost:8080`, `[::1]` for `[::1]:8080`; empty where no port follows the
// colon.
std::string without_port(std::string_view authority) {
  const auto from = authority.starts_with('[') ? authority.find(']') : 0;
  const auto colon = std::min(authority.find(':', std::min(from, authority.size())), authority.size());
  const auto port = authority.substr(std::min(colon + 1, authority.size()));
  const bool digits = std::all_of(port.begin(), port.end(), [](char c) { return c >= '0' && c <= '9'; });
  return digits && port.size() <= 5 ? lowered(authority.substr(0, colon)) : std::string();
}

// html_or returns a refusal as an HTML page where a browser asks for one.
Answer html_or(const RequestHead& head, Answer refusal, std::string_view title, std::string_view why) {
  constexpr std::string_view html = "text/html";
  const std::string problem = refusal.type;
  if (negotiate(head.field("accept"), std::array<std::string_view, 2>{problem, html}) == 1) {
    refusal.type = "text/html; charset=utf-8";
    refusal.body = fmt::format("<!doctype html>\n<title>403 Forbidden</title>\n<h1>{}</h1>\n<p>{}.\n", title, why);
    refusal.headers.emplace_back("Content-Security-Policy", "default-src 'none'");
  }
  refusal.headers.emplace_back("Vary", "Accept");
  return refusal;
}

// Large bodies are expensive to read: this waits for its turn as the work does.
Job read_in_turn(const Router::Prepare& prepare, HttpRequest request) {
  return [&prepare, request, accept = std::string(request.accept)](Admission::Pass pass) mutable {
    request.accept = accept;
    Prepared prepared = prepare(request);
    if (auto* const refusal = std::get_if<Answer>(&prepared)) {
      pass.excuse();
      return std::move(*refusal);
    }
    return std::get<Job>(prepared)(std::move(pass));
  };
}

// is_beyond tells whether a requested range begins beyond the end.
bool is_beyond(const std::string& range, std::size_t size) {
  constexpr std::string_view unit = "bytes=";
  const char* const end = range.data() + range.size();
  std::size_t from = 0;
  if (!range.starts_with(unit)) return false;
  const auto [stop, error] = std::from_chars(range.data() + unit.size(), end, from);
  const bool digits = error == std::errc() || error == std::errc::result_out_of_range;
  return digits && (error != std::errc() || from >= size) && std::string_view(stop, end) == "-";
}

// allowed returns the value of `Allow` for a refused method.
std::string_view allowed(bool computes, bool fixed) {
  return computes && fixed ? "GET, HEAD, POST, OPTIONS" : computes ? "POST, OPTIONS" : "GET, HEAD, OPTIONS";
}

}  // namespace

Router::Router(Access access, ErrorAnswer error)
    : access_(std::move(access)),
      page_policy_(fmt::format("default-src 'self'; base-uri 'none'; form-action 'self'; frame-ancestors {}; "
                               "object-src 'none'",
                               access_.frames.empty() ? "'none'" : fmt::format("{}", fmt::join(access_.frames, " ")))),
      error_(error) {
  std::erase(access_.hosts, "");  // an empty option must not allow requests without a host name
  for (auto& host : access_.hosts) host = lowered(host);
}

void Router::add_page(const Asset& asset) {
  constexpr std::string_view route = "/{file}";
  add_fixed(std::string(asset.path), route, asset.type, std::string(asset.body), true);
  if (asset.path == "/index.html") add_fixed("/", route, asset.type, std::string(asset.body), true);
}

void Router::add_text(std::string path, std::string_view route, std::string_view type, std::string body) {
  add_fixed(std::move(path), route, type, std::move(body), false);
}

void Router::add_fixed(std::string path, std::string_view route, std::string_view type, std::string body, bool page) {
  std::string etag = tag(body);
  fixed_.insert_or_assign(std::move(path), Fixed{route, std::string(type), std::move(body), std::move(etag), page});
}

void Router::add_probe(std::string_view path, Probe probe, bool apart) {
  probes_.emplace(path, ProbeAt{std::move(probe), apart});
}

void Router::add_computed(std::string_view path, Prepare prepare) { computed_.emplace(path, std::move(prepare)); }

void Router::add_hint(Hint hint) { hint_ = std::move(hint); }

void Router::add_glance(Glance glance) { glance_ = glance; }

// A page of another site can make a browser resolve the page's own name to this machine (DNS rebinding); the name in
// Host reveals it.
bool Router::host_allowed(const RequestHead& head) const {
  if (head.authority.empty() && head.count("host") == 0) return true;  // HTTP/1.0, hence no browser
  const std::string host = without_port(head.authority);
  return std::find(access_.hosts.begin(), access_.hosts.end(), host) != access_.hosts.end();
}

// Usually somebody has opened the page by the name of the machine: the message is for a person with a browser.
Answer Router::unknown_host(const RequestHead& head, std::string_view request_id) const {
  const std::string host = without_port(head.authority);
  const bool is_name = !host.empty() && std::all_of(host.begin(), host.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') ||
           std::string_view("-._:[]").find(c) != std::string_view::npos;
  });
  const std::string name = is_name ? host : "NAME";
  const std::string why = fmt::format(
      "this Host is not served here: a service answers only to names that it was told, so that no foreign page can use "
      "it. Whoever runs it adds this one by `--allow-host {0}`, or LEASTACTION_ALLOW_HOST={0}; on its own machine it "
      "is "
      "found by 127.0.0.1 or localhost",
      name);
  return html_or(head, error_(403, why, request_id), "Not by this name", why);
}

bool Router::origin_allowed(const RequestHead& head) const {
  if (head.count("origin") == 0) return true;
  const std::string origin = head.field("origin"), host = lowered(head.authority);
  return lowered(origin) == "http://" + host || lowered(origin) == "https://" + host ||
         std::find(access_.origins.begin(), access_.origins.end(), origin) != access_.origins.end();
}

// frame_refused tells whether a browser is about to load the page into a frame that is not allowed. Browsers send these
// fields only to services with TLS or on their own machine; elsewhere only the policy of the page prevents it.
bool Router::frame_refused(const RequestHead& head) const {
  constexpr std::string_view frames[] = {"iframe", "frame", "embed", "object", "fencedframe"};
  const std::string into = head.field("sec-fetch-dest"), referrer = lowered(head.field("referer"));
  if (std::find(std::begin(frames), std::end(frames), into) == std::end(frames)) return false;
  if (access_.frames.empty()) return true;
  const auto scheme = referrer.find("://");
  if (scheme == referrer.npos) return false;  // the embedding page is not told: the policy of the page decides
  const std::string origin = referrer.substr(0, referrer.find('/', scheme + 3));
  return std::find(access_.frames.begin(), access_.frames.end(), origin) == access_.frames.end();
}

// This answer appears in the frame instead of the page, for the person who embeds it.
Answer Router::refused_frame(const RequestHead& head, std::string_view request_id) const {
  const std::string why =
      "the page may not stand in a frame of this origin: whoever runs the service adds it by `--allow-frame ORIGIN`, "
      "as `--allow-frame https://course.example`, or LEASTACTION_ALLOW_FRAME=ORIGIN";
  Answer answer = html_or(head, error_(403, why, request_id), "Not in this frame", why);
  answer.headers.emplace_back("Vary", "Sec-Fetch-Dest, Referer");
  return answer;
}

Effort Router::effort(const RequestHead& head, std::string_view body) const {
  return head.method == "POST" && computed_.contains(head.path) ? glance_(body) : Effort::brief;
}

// With Accept-Encoding the file may be large, or have to be compressed first.
bool Router::is_short(const RequestHead& head, Effort effort) const {
  return effort == Effort::brief && (!fixed_.contains(head.path) || head.count("accept-encoding") == 0);
}

Routed Router::operator()(const RequestHead& head, const HttpRequest& request) const {
  std::string_view route = "unmatched";
  Prepared outcome = dispatch(head, request, route);
  return {std::move(outcome), route};
}

void Router::dress(const RequestHead& head, std::string_view route, Answer& answer) const {
  auto& headers = answer.headers;
  headers.reserve(8);  // including those of every answer
  if (head.method == "POST" && computed_.contains(route)) {
    headers.emplace_back("Vary", "Accept, Accept-Encoding");
    headers.emplace_back("Cache-Control", "no-store");
  }
  const auto encoded = [](const auto& field) { return field.first == "Content-Encoding"; };
  if (takes_gzip(head.field("accept-encoding")) && std::none_of(headers.begin(), headers.end(), encoded)) {
    compress(answer);
  }
  headers.emplace_back("X-Content-Type-Options", "nosniff");
  const std::string origin = head.field("origin");
  if (std::find(access_.origins.begin(), access_.origins.end(), origin) != access_.origins.end()) {
    headers.emplace_back("Access-Control-Allow-Origin", origin);
    headers.emplace_back("Access-Control-Expose-Headers", "*");
    headers.emplace_back("Vary", "Origin");
    headers.emplace_back("Timing-Allow-Origin", origin);
  }
}

Prepared Router::dispatch(const RequestHead& head, const HttpRequest& request, std::string_view& route) const {
  const auto probe = probes_.find(head.path);
  const bool apart = probe != probes_.end() && probe->second.apart;
  const bool probes = probe != probes_.end() && apart == request.for_metrics;
  if (request.for_metrics && !probes) return error_(404, "this port is for metrics", request.id);
  if (!probes && !host_allowed(head)) return unknown_host(head, request.id);
  if (apart && !probes) return error_(404, "this is at another port, --metrics-port", request.id);
  if (!origin_allowed(head)) {
    return error_(403, "pages of this Origin may not ask; --allow-origin adds one", request.id);
  }
  if (head.path == "*") return Answer{204, "", "", {{"Allow", "GET, HEAD, POST, OPTIONS"}}};  // about the whole service
  const auto found = fixed_.find(head.path);
  const auto endpoint = computed_.find(head.path);
  const bool has_text = found != fixed_.end(), can_compute = endpoint != computed_.end();
  const bool computes = can_compute && (!has_text || head.method == "POST");
  if (!can_compute && !probes && !has_text)
    return error_(404, "nothing is at this path" + hint_(404, head.path), request.id);
  route = computes ? endpoint->first : probes ? probe->first : found->second.route;

  if (head.method == "OPTIONS") {
    Answer answer{204, "", "", {{"Allow", std::string(allowed(can_compute, has_text))}}};
    answer.headers.emplace_back("Access-Control-Allow-Methods", !can_compute ? "GET, HEAD"
                                                                : has_text   ? "GET, HEAD, POST"
                                                                             : "POST");
    answer.headers.emplace_back("Access-Control-Allow-Headers", "Accept, Content-Type");
    return answer;
  }
  if (computes ? head.method != "POST" : head.method != "GET" && head.method != "HEAD") {
    Answer answer = error_(405, head.method + " does not go with this path" + hint_(405, head.path), request.id);
    answer.headers.emplace_back("Allow", allowed(can_compute, has_text));
    return answer;
  }
  if (probes) {
    Answer answer = probe->second.answer(request.id);
    answer.headers.emplace_back("Cache-Control", "no-store");
    answer.headers.emplace_back("Vary", "Accept-Encoding");
    return answer;
  }
  if (!computes && found->second.page && frame_refused(head)) return refused_frame(head, request.id);
  if (!computes) return fixed(head, found->second, request.id);
  if (head.count("content-length") == 0 && head.count("transfer-encoding") == 0) {
    return error_(411, "Content-Length or chunked coding is required", request.id);
  }
  if (request.body.size() > soon_read && glance_(request.body) != Effort::brief)
    return read_in_turn(endpoint->second, request);
  return endpoint->second(request);
}

Answer Router::fixed(const RequestHead& head, const Fixed& fixed, std::string_view request_id) const {
  const std::string_view media = std::string_view(fixed.type).substr(0, fixed.type.find(';'));
  if (!negotiate(head.field("accept"), {&media, 1})) {
    return error_(406, "the answer comes as " + std::string(media), request_id);
  }
  const bool packed = worth_gzip(media, fixed.body.size()) && takes_gzip(head.field("accept-encoding"));
  // Compressed content has other bytes, so that its tag must be weak.
  Answer answer{
      200, fixed.type, {}, {{"ETag", packed ? "W/" + fixed.etag : fixed.etag}, {"Cache-Control", "no-cache"}}};
  answer.headers.emplace_back("Vary", "Accept-Encoding");
  if (fixed.page) {
    answer.headers.emplace_back("Content-Security-Policy", page_policy_);
    answer.headers.emplace_back("Referrer-Policy", "no-referrer");
  }
  const std::string known = head.field("if-none-match");
  if (known == "*" || known.find(fixed.etag) != std::string::npos) {
    answer.status = 304;
  } else if (packed) {
    std::call_once(fixed.packed->made, [&] { fixed.packed->body = gzipped(fixed.body, 6); });
    answer.body = fixed.packed->body;
    answer.headers.emplace_back("Content-Encoding", "gzip");
  } else {
    answer.body = fixed.body;
  }
  // With If-Range the part belongs to the client's version: any other version is answered whole.
  const bool conditional = head.count("if-range") > 0;
  if (answer.status == 200 && head.method == "GET" && !conditional &&
      is_beyond(head.field("range"), answer.body.size())) {
    Answer refusal = error_(416, "nothing is there", request_id);
    refusal.headers.emplace_back("Content-Range", fmt::format("bytes */{}", answer.body.size()));
    return refusal;
  }
  return answer;
}

}  // namespace least::server
