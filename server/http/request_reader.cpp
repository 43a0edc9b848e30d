#include "server/http/request_reader.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <utility>

namespace least::server {
namespace {

constexpr std::size_t longest_size_line = 256;  // of a chunk

// Bytes of the end of a head, and of a line, that may arrive beyond the limits.
constexpr std::size_t part_of_end = 3, part_of_line = 1;

Refusal malformed_chunks() { return {400, "malformed chunked coding"}; }

}  // namespace

std::string full_memory(const MemoryBudget& memory) {
  return "requests and answers fill the memory for them, " + std::to_string(memory.most()) + " bytes (--max-memory)";
}

std::string beyond_memory(const MemoryBudget& memory) {
  return "the request needs more than the " + std::to_string(memory.most()) +
         " bytes of memory that all requests share (--max-memory): ask for a smaller scene, or for less of it";
}

Received RequestReader::read() {
  Received received = next();
  if (!std::holds_alternative<Refused>(received)) {
    auto* const whole = std::get_if<Message>(&received);
    Message& message = whole ? *whole : message_;
    const std::size_t bytes = buffer_.capacity() + message.body.capacity();
    if (bytes <= small || held_.grow_to(bytes)) {
      if (whole) whole->held = std::exchange(held_, Held(memory_));
      return received;
    }
    received = Refused{{503, full_memory(*memory_)}, message.head.method};
  }
  std::string().swap(buffer_);
  message_ = {};
  held_ = Held(memory_);
  return received;
}

Received RequestReader::next() {
  if (part_ == Part::head) {
    if (auto refused = read_head()) return std::move(*refused);
  }
  if (part_ == Part::body || part_ == Part::trailer) {
    if (auto refusal = framing_.chunked ? read_chunked() : read_body()) {
      return Refused{std::move(*refusal), message_.head.method};
    }
  }
  if (part_ != Part::whole) return {};
  if (buffer_.empty() && buffer_.capacity() > small) std::string().swap(buffer_);
  part_ = Part::head;
  return std::exchange(message_, {});
}

RequestReader::Awaits RequestReader::awaits() const {
  if (part_ != Part::head) return Awaits::body;
  constexpr std::size_t tolerated = 2;  // a CRLF, which some clients add to a body
  return buffer_.empty() && blank_ <= tolerated ? Awaits::request : Awaits::head;
}

bool RequestReader::asks_to_continue() { return std::exchange(asks_, false); }

Refused RequestReader::too_late() const {
  if (part_ == Part::head) return {{408, "the head of the request did not come in time"}, ""};
  return {{408, "the body of the request did not come in time"}, message_.head.method};
}

std::optional<Refused> RequestReader::read_head() {
  // Blank lines before a request are tolerated (RFC 9112, 2.2), within the same bounds.
  std::size_t blank = 0;
  while (buffer_.compare(blank, 2, "\r\n") == 0) blank += 2;
  if (blank > 0) {
    buffer_.erase(0, blank);
    looked_ = 0;
    blank_ += blank;
  }
  if (blank_ > bounds_.head.bytes) return Refused{{400, "nothing but blank lines"}, ""};
  const auto end = buffer_.find("\r\n\r\n", looked_);
  const std::string known = buffer_.starts_with("HEAD ") ? "HEAD" : "";
  const std::size_t known_size =
      end == std::string::npos ? buffer_.size() - std::min(buffer_.size(), part_of_end) : end;
  if (known_size > bounds_.head.bytes) {
    return Refused{{431, "the head is larger than " + std::to_string(bounds_.head.bytes) + " bytes"}, known};
  }
  if (end == std::string::npos) {
    if (auto refusal = refusal_at_once(buffer_)) return Refused{std::move(*refusal), ""};
    looked_ = buffer_.size() - std::min(buffer_.size(), part_of_end);
    return std::nullopt;
  }
  looked_ = 0;
  auto head = parse_head(std::string_view(buffer_).substr(0, end), bounds_.head);
  if (!head) return Refused{std::move(head.error()), known};
  const auto framing = framing_of(*head, bounds_.body);
  if (!framing) return Refused{framing.error(), head->method};
  buffer_.erase(0, end + 4);
  blank_ = 0;
  framing_ = *framing;
  message_ = {std::move(*head), {}, framing_.keep_alive};
  asks_ = framing_.expects_continue && buffer_.empty();
  chunk_.reset();
  trailer_ = 0;
  part_ = Part::body;
  return std::nullopt;
}

std::optional<Refusal> RequestReader::read_body() {
  if (buffer_.size() < framing_.length) return std::nullopt;
  if (buffer_.size() == framing_.length) {
    message_.body = std::exchange(buffer_, {});
  } else {
    message_.body = buffer_.substr(0, framing_.length);
    buffer_.erase(0, framing_.length);
  }
  part_ = Part::whole;
  return std::nullopt;
}

// What has been parsed is removed from the buffer once, not after each chunk: otherwise a client could make every byte
// of a body move the whole buffer.
std::optional<Refusal> RequestReader::read_chunked() {
  std::size_t at = 0;
  auto refusal = part_ == Part::body ? read_chunks(at) : std::nullopt;
  if (!refusal && part_ == Part::trailer) refusal = read_trailer(at);
  buffer_.erase(0, at);
  return refusal;
}

std::optional<Refusal> RequestReader::read_chunks(std::size_t& at) {
  std::string& body = message_.body;
  for (;;) {
    if (!chunk_) {  // a size, and perhaps an extension, which is ignored
      const auto line = read_line(at, longest_size_line);
      if (!line)
        return buffer_.size() - at > longest_size_line + part_of_line ? std::optional(malformed_chunks())
                                                                      : std::nullopt;
      // Another reader may take a bare line feed for the end of the line
      if (!is_field_value(*line)) return malformed_chunks();
      std::uint32_t size = 0;
      const auto digits = std::min(line->find_first_of("; \t"), line->size());
      const auto rest = std::min(line->find_first_not_of(" \t", digits), line->size());
      if (rest < line->size() && (*line)[rest] != ';') return malformed_chunks();
      const auto [stop, error] = std::from_chars(line->data(), line->data() + digits, size, 16);
      if (error == std::errc::result_out_of_range) return Refusal{413, "a chunk is too large"};
      if (error != std::errc() || stop != line->data() + digits) return malformed_chunks();
      if (size == 0) {
        part_ = Part::trailer;
        return std::nullopt;
      }
      if (size > bounds_.body - body.size()) {
        return Refusal{413, "the body is larger than " + std::to_string(bounds_.body) + " bytes"};
      }
      chunk_ = size;
    }
    if (buffer_.size() - at < *chunk_ + 2) return std::nullopt;
    if (buffer_.compare(at + *chunk_, 2, "\r\n") != 0) return malformed_chunks();
    body.append(buffer_, at, *chunk_);
    at += *chunk_ + 2;
    chunk_.reset();
  }
}

// The fields of a trailer are read and ignored.
std::optional<Refusal> RequestReader::read_trailer(std::size_t& at) {
  while (trailer_ <= bounds_.head.bytes) {
    const auto line = read_line(at, bounds_.head.bytes);
    if (!line)
      return buffer_.size() - at > bounds_.head.bytes + part_of_line ? std::optional(malformed_chunks()) : std::nullopt;
    if (line->empty()) {
      part_ = Part::whole;
      return std::nullopt;
    }
    if (!is_field_value(*line)) return malformed_chunks();  // as above
    trailer_ += line->size() + 2;
  }
  return Refusal{431, "the trailer is too large"};
}

std::optional<std::string_view> RequestReader::read_line(std::size_t& at, std::size_t longest) const {
  const std::string_view rest = std::string_view(buffer_).substr(at);
  const std::size_t end = rest.find("\r\n");
  if (end == rest.npos || end > longest) return std::nullopt;
  at += end + 2;
  return rest.substr(0, end);
}

}  // namespace least::server
