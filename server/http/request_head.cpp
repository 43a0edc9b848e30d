#include "server/http/request_head.hpp"

#include <algorithm>
#include <charconv>

namespace least::server {
namespace {

constexpr char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

bool is_token(std::string_view s) {
  const auto good = [](char c) {
    return (c >= '0' && c <= '9') || (lower(c) >= 'a' && lower(c) <= 'z') ||
           std::string_view("!#$%&'*+-.^_`|~").find(c) != std::string_view::npos;
  };
  return !s.empty() && std::all_of(s.begin(), s.end(), good);
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

// The next line without its CRLF, taken off the text. A line feed alone ends no line: what one reader takes for two
// requests another takes for one.
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
  if (target.front() != '/' && target != "*") return Refusal{400, "the target must be a path"};
  RequestHead head;
  head.method = method;
  head.minor = version.back() - '0';
  const auto mark = std::min(target.find('?'), target.size());
  head.path = target.substr(0, mark);
  head.query = target.substr(std::min(mark + 1, target.size()));
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
  for (const auto& [key, value] : fields) {
    if (key != name) continue;
    if (!values.empty()) values += ", ";
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
  return head;
}

Result<Framing, Refusal> framing_of(const RequestHead& head, std::uint64_t body_limit) {
  Framing framing;
  const std::string connection = head.field("connection");
  framing.keep_alive = head.minor == 1 ? !lists(connection, "close") : lists(connection, "keep-alive");

  const bool has_length = head.count("content-length") > 0;
  if (head.count("transfer-encoding") > 0) {
    // Both, or an encoding in HTTP/1.0, is how requests are smuggled past a proxy.
    if (has_length || head.minor == 0) return Refusal{400, "Transfer-Encoding contradicts Content-Length"};
    if (lowered(head.field("transfer-encoding")) != "chunked") return Refusal{501, "only chunked is understood"};
    framing.chunked = true;
  } else if (has_length) {
    const std::string text = head.field("content-length");  // two of them are joined by a comma: no number
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
