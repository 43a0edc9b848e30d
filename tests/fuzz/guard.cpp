#include <algorithm>
#include <string>
#include <variant>
#include <vector>

#include "server/http/request_reader.hpp"
#include "tests/fuzz/targets.hpp"

namespace least::fuzz {
namespace {

using namespace least::server;

// Small, so that bounds are reached soon.
constexpr RequestBounds narrow{{96, 24, 4}, 16};
constexpr RequestBounds wide{{4096, 1024, 20}, 1024};

struct Heard {
  std::vector<Message> messages;
  bool refused = false;
  RequestReader::Awaits awaits = RequestReader::Awaits::request;
};

Heard hear(std::string_view bytes, std::size_t piece, const RequestBounds& bounds) {
  constexpr int statuses[] = {400, 413, 414, 415, 417, 431, 501, 505};
  RequestReader reader(bounds);
  Heard heard;
  for (std::size_t at = 0; at < bytes.size(); at += piece) {
    reader.buffer() += bytes.substr(at, piece);
    for (;;) {
      Received received = reader.read();
      reader.asks_to_continue();
      if (std::holds_alternative<std::monostate>(received)) break;
      if (const auto* const refused = std::get_if<Refused>(&received)) {
        ensure(std::ranges::count(statuses, refused->refusal.status) == 1, "a refusal with another status");
        ensure(reader.buffer().empty(), "something is kept after a refusal");
        heard.refused = true;
        return heard;
      }
      heard.messages.push_back(std::move(std::get<Message>(received)));
    }
  }
  heard.awaits = reader.awaits();
  return heard;
}

bool is_clean(std::string_view text) {
  return std::ranges::none_of(text, [](char c) { return c == '\r' || c == '\n' || c == '\0'; });
}

bool is_same(const Message& a, const Message& b) {
  return a.head.method == b.head.method && a.head.path == b.head.path && a.head.authority == b.head.authority &&
         a.head.minor == b.head.minor && a.body == b.body && a.keep_alive == b.keep_alive;
}

// strictly() writes a message as a proxy would pass it on, without any ambiguity.
std::string strictly(const Message& message) {
  const RequestHead& head = message.head;
  std::string text = head.method + ' ' + head.path;
  text += head.minor == 1 ? " HTTP/1.1\r\n" : " HTTP/1.0\r\n";
  for (const auto& [name, value] : head.fields) {
    const bool frames = name == "content-length" || name == "transfer-encoding";
    if (!frames) text += name + ": " + (name == "host" ? head.authority : value) + "\r\n";
  }
  return text + "content-length: " + std::to_string(message.body.size()) + "\r\n\r\n" + message.body;
}

void check(const Message& message) {
  const RequestHead& head = message.head;
  ensure(message.body.size() <= narrow.body, "a body beyond the bound");
  ensure(head.fields.size() <= narrow.head.fields, "fields beyond the bound");
  ensure(head.path.size() <= narrow.head.target, "a target beyond the bound");
  ensure(head.path.starts_with('/') || (head.path == "*" && head.method == "OPTIONS"), "a target that is no path");
  ensure(head.count("host") <= 1 && head.count("content-length") <= 1, "a field that is there twice");
  ensure(head.count("content-length") == 0 || head.count("transfer-encoding") == 0, "two ways to frame a body");
  ensure(is_clean(head.method) && is_clean(head.path), "an end of a line in the first one");
  for (const auto& [name, value] : head.fields) {
    ensure(is_clean(name) && is_clean(value), "an end of a line in a field");
    ensure(name == lowered(name) && value == trimmed(value), "a field that is not as it is looked up");
  }
  const Heard again = hear(strictly(message), 4096, wide);
  ensure(!again.refused && again.messages.size() == 1, "no request when it is written down strictly");
  const bool absolute = head.count("host") == 0;  // HTTP/1.0, where only an absolute target names the authority
  ensure(absolute || is_same(again.messages.front(), message), "another request when it is written down strictly");
}

}  // namespace

void guard(std::string_view bytes) {
  if (bytes.empty()) return;
  const std::size_t piece = 1 + static_cast<unsigned char>(bytes.front()) % 40;
  bytes.remove_prefix(1);
  const Heard whole = hear(bytes, std::max<std::size_t>(bytes.size(), 1), narrow);
  const Heard cut = hear(bytes, piece, narrow);
  ensure(whole.refused == cut.refused, "refused or not, by how it is cut");
  ensure(whole.awaits == cut.awaits, "something else is awaited, by how it is cut");
  ensure(std::ranges::equal(whole.messages, cut.messages, is_same), "other requests, by how it is cut");
  for (const Message& message : whole.messages) check(message);
}

}  // namespace least::fuzz
