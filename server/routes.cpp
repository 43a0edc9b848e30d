#include "server/routes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

#include "server/encode/catalogue_json.hpp"
#include "server/encode/problem_document.hpp"
#include "server/http/accept.hpp"
#include "server/simulate.hpp"
#include "server/study.hpp"

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

// What computes, by path.
struct Computed {
  std::string_view path;
  Endpoint answer;
};
constexpr Computed computed[] = {
    {"/v1/simulate", simulate}, {"/v1/work-precision", measure_work_precision}, {"/v1/stability", measure_stability}};

}  // namespace

Routes::Routes(const Context& context, Access access, std::span<const Asset> assets)
    : context_(context), access_(std::move(access)) {
  for (auto& host : access_.hosts) host = lowered(host);
  const auto add = [this](std::string path, std::string_view route, std::string_view type, std::string body,
                          bool page = false) {
    std::string etag = tag(body);
    fixed_.insert_or_assign(std::move(path), Fixed{route, std::string(type), std::move(body), std::move(etag), page});
  };
  for (const Asset& asset : assets) {
    add(std::string(asset.path), asset.path, asset.type, std::string(asset.body), true);
    if (asset.path == "/index.html") add("/", "/", asset.type, std::string(asset.body), true);
  }
  CatalogueText text = describe(context.cards);
  add("/v1/catalogue", "/v1/catalogue", "application/json", std::move(text.all) + '\n');
  for (auto& [id, body] : text.problems) {
    add("/v1/problems/" + id, "/v1/problems/{id}", "application/json", std::move(body) + '\n');
  }
  for (auto& [id, body] : text.schemes) {
    add("/v1/schemes/" + id, "/v1/schemes/{id}", "application/json", std::move(body) + '\n');
  }
  add("/healthz", "/healthz", "application/json", "{\"status\":\"ok\"}\n");
}

// A page of another site can make a browser resolve its own name to this machine; then the name in Host gives it away.
bool Routes::host_allowed(const Head& head) const {
  if (head.count("host") == 0) return true;  // HTTP/1.0: no browser
  const std::string host = without_port(head.field("host"));
  return std::find(access_.hosts.begin(), access_.hosts.end(), host) != access_.hosts.end();
}

bool Routes::origin_allowed(const Head& head) const {
  if (head.count("origin") == 0) return true;
  const std::string origin = head.field("origin"), host = lowered(head.field("host"));
  return lowered(origin) == "http://" + host || lowered(origin) == "https://" + host ||
         std::find(access_.origins.begin(), access_.origins.end(), origin) != access_.origins.end();
}

Routed Routes::operator()(const Head& head, std::string_view body, std::string_view request_id,
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

Answer Routes::dispatch(const Head& head, const Question& question, std::string_view& route) const {
  if (!host_allowed(head)) {
    return problem_document(403, "this Host is not served here; --allow-host adds one", question.id);
  }
  if (!origin_allowed(head)) {
    return problem_document(403, "pages of this Origin may not ask; --allow-origin adds one", question.id);
  }
  const auto found = fixed_.find(head.path);
  const auto endpoint =
      std::find_if(std::begin(computed), std::end(computed), [&](const Computed& c) { return c.path == head.path; });
  const bool computes = endpoint != std::end(computed);
  if (!computes && found == fixed_.end()) return problem_document(404, "nothing is at this path", question.id);
  route = computes ? endpoint->path : found->second.route;

  if (head.method == "OPTIONS") {
    Answer answer{204, "", "", {{"Allow", computes ? "POST, OPTIONS" : "GET, HEAD, OPTIONS"}}};
    answer.headers.emplace_back("Access-Control-Allow-Methods", computes ? "POST" : "GET, HEAD");
    answer.headers.emplace_back("Access-Control-Allow-Headers", "Accept, Content-Type");
    return answer;
  }
  if (computes ? head.method != "POST" : head.method != "GET" && head.method != "HEAD") {
    Answer answer = problem_document(405, head.method + " does not go with this path", question.id);
    answer.headers.emplace_back("Allow", computes ? "POST, OPTIONS" : "GET, HEAD, OPTIONS");
    return answer;
  }
  if (!computes) return fixed(head, found->second, question.id);
  if (head.count("content-length") == 0 && head.count("transfer-encoding") == 0) {
    return problem_document(411, "Content-Length or chunked coding is required", question.id);
  }
  Answer answer = endpoint->answer(context_, question);
  answer.headers.emplace_back("Vary", "Accept");
  answer.headers.emplace_back("Cache-Control", "no-store");
  return answer;
}

Answer Routes::fixed(const Head& head, const Fixed& fixed, std::string_view request_id) const {
  const std::string_view media = std::string_view(fixed.type).substr(0, fixed.type.find(';'));
  if (!negotiate(head.field("accept"), {&media, 1})) {
    return problem_document(406, "the answer comes as " + std::string(media), request_id);
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
