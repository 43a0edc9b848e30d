#include "server/http/router.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

#include "server/http/accept.hpp"

namespace least::server {
namespace {

// A name for a content: FNV-1a. Tells versions apart, guards nothing.
std::string tag(std::string_view body) {
  std::uint64_t hash = 14695981039346656037u;
  for (const char c : body) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211u;
  return fmt::format("\"{:016x}\"", hash);
}

// `localhost` from `LocalHost:8080`, `[::1]` from `[::1]:8080`.
std::string without_port(std::string_view authority) {
  const auto from = authority.starts_with('[') ? authority.find(']') : 0;
  const auto colon = authority.find(':', std::min(from, authority.size()));
  return lowered(authority.substr(0, colon));
}

}  // namespace

Router::Router(Access access, ErrorAnswer error) : access_(std::move(access)), error_(error) {
  for (auto& host : access_.hosts) host = lowered(host);
}

void Router::add_page(const Asset& asset) {
  add_fixed(std::string(asset.path), asset.path, asset.type, std::string(asset.body), true);
  if (asset.path == "/index.html") add_fixed("/", "/", asset.type, std::string(asset.body), true);
}

void Router::add_text(std::string path, std::string_view route, std::string_view type, std::string body) {
  add_fixed(std::move(path), route, type, std::move(body), false);
}

void Router::add_fixed(std::string path, std::string_view route, std::string_view type, std::string body, bool page) {
  std::string etag = tag(body);
  fixed_.insert_or_assign(std::move(path), Fixed{route, std::string(type), std::move(body), std::move(etag), page});
}

void Router::add_computed(std::string_view path, Compute compute) { computed_.emplace(path, std::move(compute)); }

// A page of another site can make a browser resolve its own name to this machine; then the name in Host gives it away.
bool Router::host_allowed(const RequestHead& head) const {
  if (head.count("host") == 0) return true;  // HTTP/1.0: no browser
  const std::string host = without_port(head.field("host"));
  return std::find(access_.hosts.begin(), access_.hosts.end(), host) != access_.hosts.end();
}

bool Router::origin_allowed(const RequestHead& head) const {
  if (head.count("origin") == 0) return true;
  const std::string origin = head.field("origin"), host = lowered(head.field("host"));
  return lowered(origin) == "http://" + host || lowered(origin) == "https://" + host ||
         std::find(access_.origins.begin(), access_.origins.end(), origin) != access_.origins.end();
}

Routed Router::operator()(const RequestHead& head, std::string_view body, std::string_view request_id,
                          const std::function<bool()>& gone) const {
  Routed routed{{}, "unmatched"};
  const std::string accept = head.field("accept");
  routed.answer = dispatch(head, {body, accept, request_id, gone}, routed.route);
  auto& headers = routed.answer.headers;
  headers.emplace_back("X-Content-Type-Options", "nosniff");
  const std::string origin = head.field("origin");
  if (std::find(access_.origins.begin(), access_.origins.end(), origin) != access_.origins.end()) {
    headers.emplace_back("Access-Control-Allow-Origin", origin);
    headers.emplace_back("Access-Control-Expose-Headers", "*");
    headers.emplace_back("Vary", "Origin");
  }
  return routed;
}

Answer Router::dispatch(const RequestHead& head, const HttpRequest& request, std::string_view& route) const {
  if (!host_allowed(head)) {
    return error_(403, "this Host is not served here; --allow-host adds one", request.id);
  }
  if (!origin_allowed(head)) {
    return error_(403, "pages of this Origin may not ask; --allow-origin adds one", request.id);
  }
  const auto found = fixed_.find(head.path);
  const auto endpoint = computed_.find(head.path);
  const bool computes = endpoint != computed_.end();
  if (!computes && found == fixed_.end()) return error_(404, "nothing is at this path", request.id);
  route = computes ? endpoint->first : found->second.route;

  if (head.method == "OPTIONS") {
    Answer answer{204, "", "", {{"Allow", computes ? "POST, OPTIONS" : "GET, HEAD, OPTIONS"}}};
    answer.headers.emplace_back("Access-Control-Allow-Methods", computes ? "POST" : "GET, HEAD");
    answer.headers.emplace_back("Access-Control-Allow-Headers", "Accept, Content-Type");
    return answer;
  }
  if (computes ? head.method != "POST" : head.method != "GET" && head.method != "HEAD") {
    Answer answer = error_(405, head.method + " does not go with this path", request.id);
    answer.headers.emplace_back("Allow", computes ? "POST, OPTIONS" : "GET, HEAD, OPTIONS");
    return answer;
  }
  if (!computes) return fixed(head, found->second, request.id);
  if (head.count("content-length") == 0 && head.count("transfer-encoding") == 0) {
    return error_(411, "Content-Length or chunked coding is required", request.id);
  }
  Answer answer = endpoint->second(request);
  answer.headers.emplace_back("Vary", "Accept");
  answer.headers.emplace_back("Cache-Control", "no-store");
  return answer;
}

Answer Router::fixed(const RequestHead& head, const Fixed& fixed, std::string_view request_id) const {
  const std::string_view media = std::string_view(fixed.type).substr(0, fixed.type.find(';'));
  if (!negotiate(head.field("accept"), {&media, 1})) {
    return error_(406, "the answer comes as " + std::string(media), request_id);
  }
  Answer answer{200, fixed.type, fixed.body, {{"ETag", fixed.etag}, {"Cache-Control", "no-cache"}}};
  if (fixed.page) {
    answer.headers.emplace_back("Content-Security-Policy",
                                "default-src 'self'; base-uri 'none'; form-action 'self'; frame-ancestors 'none'; "
                                "object-src 'none'");
    answer.headers.emplace_back("Referrer-Policy", "no-referrer");
  }
  if (head.field("if-none-match").find(fixed.etag) != std::string::npos) {
    answer.status = 304;
    answer.body.clear();
  }
  return answer;
}

}  // namespace least::server
