#include "server/http/request_head.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <utility>

namespace least::server {
namespace {

constexpr char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

bool is_token(std::string_view s) {
  static constexpr auto good = [] {
    std::array<bool, 256> all{};
    for (const char c :
         std::string_view("!#$%&'*+-.^_`|~0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"))
      all[static_cast<unsigned char>(c)] = true;
    return all;
  }();
  return !s.empty() && std::all_of(s.begin(), s.end(), [](char c) { return good[static_cast<unsigned char>(c)]; });
}

bool is_visible(std::string_view s) {
  return std::all_of(s.begin(), s.end(), [](char c) { return c > 0x20 && c < 0x7F; });
}

bool is_value(std::string_view s) {
  return std::all_of(s.begin(), s.end(), [](char c) {
    const auto u = static_cast<unsigned char>(c);
    return u == '\t' || (u >= 0x20 && u != 0x7F);
  });
}

// next_line removes the next line and returns it without its CRLF. A bare line feed does not end a line: otherwise this
// reader could see two requests where another one sees one.
std::string_view next_line(std::string_view& text) {
  const auto end = std::min(text.find("\r\n"), text.size());
  const auto line = text.substr(0, end);
  text.remove_prefix(std::min(end + 2, text.size()));
  return line;
}

bool lists(std::string_view values, std::string_view word) {
  while (!values.empty()) {
    const auto comma = std::min(values.find(','), values.size());
    if (lowered(trimmed(values.substr(0, comma))) == word) return true;
    values.remove_prefix(std::min(comma + 1, values.size()));
  }
  return false;
}

// absolute returns `host:80` of the target `http://host:80/path`, a form that servers must accept although only proxies
// receive it (RFC 9112, 3.2.2).
std::optional<std::string_view> absolute(std::string_view target) {
  const auto slashes = target.find("://");
  const std::string scheme = lowered(target.substr(0, std::min(slashes, target.size())));
  if (scheme != "http" && scheme != "https") return std::nullopt;
  const auto authority = target.substr(slashes + 3);
  const auto end = authority.substr(0, authority.find_first_of("/?"));
  return end.empty() ? std::nullopt : std::optional(end);
}

Result<RequestHead, Refusal> parse_request_line(std::string_view line, const HeadBounds& bounds) {
  const auto first = line.find(' '), last = line.rfind(' ');
  if (first == line.npos || first == last) return Refusal{400, "malformed request line"};
  const auto method = line.substr(0, first), target = line.substr(first + 1, last - first - 1),
             version = line.substr(last + 1);
  if (!is_token(method) || method.size() > 32) return Refusal{400, "malformed method"};
  if (target.size() > bounds.target) return Refusal{414, "the target is too long"};
  if (target.empty() || !is_visible(target)) return Refusal{400, "malformed target"};
  if (version != "HTTP/1.1" && version != "HTTP/1.0") {
    const bool http = version.starts_with("HTTP/") && version.size() == 8;
    return http ? Refusal{505, "HTTP/1.1 is spoken here"} : Refusal{400, "malformed request line"};
  }
  RequestHead head;
  head.method = method;
  head.minor = version.back() - '0';
  std::string_view path = target;
  if (const auto authority = absolute(target)) {
    head.authority = *authority;
    path.remove_prefix(static_cast<std::size_t>(authority->data() + authority->size() - target.data()));
    if (path.empty() || path.front() == '?') head.path = "/";
  } else if (target.front() != '/' && !(target == "*" && method == "OPTIONS")) {
    return Refusal{400, "the target must be a path"};
  }
  head.path += path.substr(0, path.find('?'));
  return head;
}

}  // namespace

std::string lowered(std::string_view s) {
  std::string out(s);
  std::transform(out.begin(), out.end(), out.begin(), lower);
  return out;
}

std::string_view trimmed(std::string_view s) {
  while (!s.empty() && (s.front() == ' ' || s.front() == '\t')) s.remove_prefix(1);
  while (!s.empty() && (s.back() == ' ' || s.back() == '\t')) s.remove_suffix(1);
  return s;
}

std::string RequestHead::field(std::string_view name) const {
  std::string values;
  bool first = true;
  for (const auto& [key, value] : fields) {
    if (key != name) continue;
    if (!std::exchange(first, false)) values += ", ";  // an empty value counts, too: two lengths are an invalid length
    values += value;
  }
  return values;
}

std::size_t RequestHead::count(std::string_view name) const {
  return static_cast<std::size_t>(
      std::count_if(fields.begin(), fields.end(), [&](const auto& f) { return f.first == name; }));
}

Result<RequestHead, Refusal> parse_head(std::string_view text, const HeadBounds& bounds) {
  auto head = parse_request_line(next_line(text), bounds);
  if (!head) return head;
  while (!text.empty()) {
    const auto line = next_line(text);
    const auto colon = line.find(':');
    if (colon == line.npos || !is_token(line.substr(0, colon)) || !is_value(line.substr(colon + 1))) {
      return Refusal{400, "malformed header field"};
    }
    if (head->fields.size() == bounds.fields) return Refusal{431, "too many header fields"};
    head->fields.emplace_back(lowered(line.substr(0, colon)), trimmed(line.substr(colon + 1)));
  }
  const auto hosts = head->count("host");
  if (hosts > 1 || (hosts == 0 && head->minor == 1)) return Refusal{400, "one Host field is required"};
  if (hosts == 1 && head->authority.empty()) head->authority = head->field("host");
  return head;
}

std::optional<Refusal> refusal_at_once(std::string_view begun) {
  if (begun.empty()) return std::nullopt;
  if (begun.front() == 0x16) return Refusal{400, "TLS is not spoken here: http, not https"};
  if (begun.front() != '\r' && !is_token(begun.substr(0, 1))) return Refusal{400, "malformed request line"};
  for (auto at = begun.find('\n'); at != begun.npos; at = begun.find('\n', at + 1)) {
    if (at == 0 || begun[at - 1] != '\r') return Refusal{400, "a line ends with CR and LF"};
  }
  return std::nullopt;
}

bool is_field_value(std::string_view text) { return is_value(text); }

Result<Framing, Refusal> framing_of(const RequestHead& head, std::uint64_t body_limit) {
  Framing framing;
  const std::string connection = head.field("connection");
  framing.keep_alive = head.minor == 1 ? !lists(connection, "close") : lists(connection, "keep-alive");

  const bool has_length = head.count("content-length") > 0;
  if (head.count("transfer-encoding") > 0) {
    // Both, or an encoding in HTTP/1.0, are ways to smuggle requests past a proxy.
    if (has_length || head.minor == 0) return Refusal{400, "Transfer-Encoding contradicts Content-Length"};
    if (lowered(head.field("transfer-encoding")) != "chunked") return Refusal{501, "only chunked is understood"};
    framing.chunked = true;
  } else if (has_length) {
    const std::string text = head.field("content-length");  // two of them are joined by a comma, which is no number
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, framing.length);
    const bool digits =
        !text.empty() && std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
    if (!digits) return Refusal{400, "malformed Content-Length"};
    if (error != std::errc() || stop != end || framing.length > body_limit) {
      return Refusal{413, "the body is larger than " + std::to_string(body_limit) + " bytes"};
    }
  }  // neither: no body (RFC 9112, 6.3)

  const std::string encoding = lowered(head.field("content-encoding"));
  if (!encoding.empty() && encoding != "identity") return Refusal{415, "the body must not be encoded"};
  if (const std::string expect = lowered(head.field("expect")); !expect.empty()) {
    if (expect != "100-continue") return Refusal{417, "only 100-continue can be expected"};
    framing.expects_continue = head.minor == 1 && (framing.chunked || framing.length > 0);
  }
  return framing;
}

}  // namespace least::server
