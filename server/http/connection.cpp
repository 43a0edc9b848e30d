#include "server/http/connection.hpp"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <charconv>

#include "server/shared/http_status.hpp"

namespace least::server {
namespace {

// How often a waiting thread looks at the lifecycle.
constexpr std::chrono::milliseconds glance{50};

int wait_for(int socket, short events, std::chrono::milliseconds time) {
  pollfd entry{socket, events, 0};
  const int ready = ::poll(&entry, 1, static_cast<int>(std::max<std::int64_t>(time.count(), 0)));
  return ready < 0 && errno == EINTR ? 0 : ready;
}

template <class Time>
std::chrono::milliseconds left(Time deadline) {
  return std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Time::clock::now());
}

}  // namespace

// Waits for the first byte of a request.
bool Connection::await_request() {
  const auto start = Clock::now();
  while (buffer_.empty()) {
    const int ready = wait_for(socket_, POLLIN, glance);
    if (ready < 0) return false;
    if (ready > 0) return fill(Clock::now() + glance);
    const auto waited = Clock::now() - start;
    if (waited > bounds_.idle || lifecycle_.cancelled) return false;
    // A connection that idles makes room when others queue for a thread or the service ends. One that has just come
    // may have its first request on the way.
    if ((lifecycle_.draining || lifecycle_.waiting > 0) && (!fresh_ || waited > 5 * glance)) return false;
  }
  return true;
}

// Receives what there is, at least one byte.
bool Connection::fill(Clock::time_point deadline) {
  char bytes[16 * 1024];
  const auto from = Clock::now();
  while (Clock::now() < deadline && !lifecycle_.cancelled) {
    // A client that says nothing more does not hold up the end.
    if (lifecycle_.draining && Clock::now() - from > 20 * glance) return false;
    const auto n = ::recv(socket_, bytes, sizeof bytes, MSG_DONTWAIT);
    if (n > 0) {
      buffer_.append(bytes, static_cast<std::size_t>(n));
      return true;
    }
    if (n == 0 || (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR)) return false;
    if (wait_for(socket_, POLLIN, std::min(glance, left(deadline))) < 0) return false;
  }
  return false;
}

Received Connection::receive() {
  if (!await_request()) return Gone{};
  const auto deadline = Clock::now() + bounds_.head_time;
  // Blank lines before a request are tolerated (RFC 9112, 2.2), within the same bounds.
  std::size_t looked = 0, end = std::string::npos;
  for (;;) {
    while (buffer_.starts_with("\r\n")) buffer_.erase(0, 2);
    end = buffer_.find("\r\n\r\n", looked);
    if (end != std::string::npos) break;
    if (buffer_.size() > bounds_.head.bytes) break;
    if (auto refusal = refusal_at_once(buffer_)) return Refused{std::move(*refusal), ""};
    looked = buffer_.size() - std::min<std::size_t>(buffer_.size(), 3);
    if (!fill(deadline)) {
      if (Clock::now() < deadline) return Gone{true};
      return Refused{{408, "the head of the request did not come in time"}, ""};
    }
  }
  fresh_ = false;
  const std::string known = buffer_.starts_with("HEAD ") ? "HEAD" : "";
  if (end == std::string::npos || end > bounds_.head.bytes) {
    return Refused{{431, "the head is larger than " + std::to_string(bounds_.head.bytes) + " bytes"}, known};
  }
  auto head = parse_head(std::string_view(buffer_).substr(0, end), bounds_.head);
  if (!head) return Refused{std::move(head.error()), known};
  const auto framing = framing_of(*head, bounds_.body);
  if (!framing) return Refused{framing.error(), head->method};
  buffer_.erase(0, end + 4);

  chunks_ = head->minor > 0;
  begin_answer(chunks_);
  Message message{std::move(*head), {}, framing->keep_alive};
  if (framing->expects_continue && buffer_.empty() && !write("HTTP/1.1 100 Continue\r\n\r\n")) return Gone{true};
  if (auto refusal = read_body(*framing, message.body)) {
    if (refusal->status == 0) return Gone{true};
    return Refused{std::move(*refusal), message.head.method};
  }
  return message;
}

// A refusal with status 0: the client is gone.
std::optional<Refusal> Connection::read_body(const Framing& framing, std::string& body) {
  const auto deadline = Clock::now() + bounds_.body_time;
  std::optional<Refusal> refusal;
  if (framing.chunked) {
    refusal = read_chunks(body, deadline);
  } else {
    while (buffer_.size() < framing.length && !refusal) {
      if (!fill(deadline)) refusal = Refusal{0, ""};
    }
    if (!refusal) {
      body = buffer_.substr(0, framing.length);
      buffer_.erase(0, framing.length);
    }
  }
  if (refusal && refusal->status == 0 && Clock::now() >= deadline) {
    refusal = Refusal{408, "the body of the request did not come in time"};
  }
  return refusal;
}

std::optional<Refusal> Connection::read_chunks(std::string& body, Clock::time_point deadline) {
  const Refusal malformed{400, "malformed chunked coding"}, gone{0, ""};
  for (;;) {
    // A size, perhaps with an extension that nobody needs.
    const auto line = read_line(256, deadline);
    if (!line) return buffer_.size() > 256 ? malformed : gone;
    if (!is_field_value(*line)) return malformed;  // a bare line feed may end the line for another reader
    std::uint32_t size = 0;
    const auto digits = std::min(line->find_first_of("; \t"), line->size());
    const auto [stop, error] = std::from_chars(line->data(), line->data() + digits, size, 16);
    if (error == std::errc::result_out_of_range) return Refusal{413, "a chunk is too large"};
    if (error != std::errc() || stop != line->data() + digits) return malformed;
    if (size == 0) break;
    if (size > bounds_.body - body.size()) {
      return Refusal{413, "the body is larger than " + std::to_string(bounds_.body) + " bytes"};
    }
    while (buffer_.size() < size + 2u) {
      if (!fill(deadline)) return gone;
    }
    if (buffer_.compare(size, 2, "\r\n") != 0) return malformed;
    body.append(buffer_, 0, size);
    buffer_.erase(0, size + 2u);
  }
  // Trailer fields are read and forgotten.
  for (std::size_t bytes = 0; bytes <= bounds_.head.bytes;) {
    const auto line = read_line(bounds_.head.bytes, deadline);
    if (!line) return buffer_.size() > bounds_.head.bytes ? malformed : gone;
    if (line->empty()) return std::nullopt;
    bytes += line->size() + 2;
  }
  return Refusal{431, "the trailer is too large"};
}

std::optional<std::string> Connection::read_line(std::size_t longest, Clock::time_point deadline) {
  std::size_t end;
  while ((end = buffer_.find("\r\n")) == std::string::npos) {
    if (buffer_.size() > longest || !fill(deadline)) return std::nullopt;
  }
  if (end > longest) return std::nullopt;
  std::string line = buffer_.substr(0, end);
  buffer_.erase(0, end + 2);
  return line;
}

bool Connection::send(const Answer& answer, bool keep_alive, bool body) {
  std::string head = "HTTP/1.1 " + std::to_string(answer.status) + ' ';
  head += phrase(answer.status);
  head += "\r\n";
  const auto field = [&](std::string_view name, std::string_view value) {
    ((head += name) += ": ") += value;
    head += "\r\n";
  };
  if (!answer.type.empty()) field("Content-Type", answer.type);
  if (answer.stream) {
    if (chunks_) field("Transfer-Encoding", "chunked");
  } else if (answer.status != 204 && answer.status != 304) {
    field("Content-Length", std::to_string(answer.body.size()));
  }
  for (const auto& [name, value] : answer.headers) field(name, value);
  field("Connection", keep_alive ? "keep-alive" : "close");
  head += "\r\n";
  sent_ = 0;
  answering_ = true;
  if (answer.stream) return write(head) && write_stream(answer);
  // A small answer leaves in one piece, a large one is not copied.
  constexpr std::size_t small = 16 * 1024;
  if (!body || answer.body.empty()) return write(head);
  sent_ = answer.body.size();
  if (answer.body.size() <= small) return write(head += answer.body);
  return write(head) && write(answer.body);
}

// Each piece is a chunk (RFC 9112, 7.1) and leaves at once. In HTTP/1.0 the body ends with the connection.
bool Connection::write_stream(const Answer& answer) {
  const bool whole = answer.stream([this](std::string_view piece) {
    if (piece.empty()) return true;  // as a chunk it would be the last
    sent_ += piece.size();
    if (!chunks_) return write(piece);
    char size[16];
    std::string chunk(size, std::to_chars(size, size + sizeof size, piece.size(), 16).ptr);
    ((chunk += "\r\n") += piece) += "\r\n";
    return write(chunk);
  });
  return whole && (!chunks_ || write("0\r\n\r\n"));
}

bool Connection::gone() {
  pollfd entry{socket_, POLLRDHUP, 0};
  if (::poll(&entry, 1, 0) <= 0) return false;
  if (entry.revents & (POLLERR | POLLHUP)) return true;
  // It will send no more; whether it still reads shows only when something is sent: who does not, answers with a reset.
  // Any number of interim answers may come before an answer (RFC 9110, 15.2), and none within one.
  if (interim_ && !answering_ && !probed_.exchange(true)) {
    constexpr std::string_view probe = "HTTP/1.1 100 Continue\r\n\r\n";
    if (::send(socket_, probe.data(), probe.size(), MSG_DONTWAIT | MSG_NOSIGNAL) < 0) return errno != EAGAIN;
  }
  return false;
}

void Connection::begin_answer(bool interim) {
  interim_ = interim;
  answering_ = probed_ = false;
  taken_ = 0;
  blocked_ = {};
}

bool Connection::write(std::string_view bytes) {
  if (!lifecycle_.cancelled)
    last_write_ = Clock::time_point::max();
  else if (last_write_ == Clock::time_point::max())
    last_write_ = Clock::now() + bounds_.stall;
  auto deadline = std::min(Clock::now() + bounds_.stall, last_write_);
  while (!bytes.empty()) {
    const auto n = ::send(socket_, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    if (n > 0) {
      bytes.remove_prefix(static_cast<std::size_t>(n));
      taken_ += static_cast<std::size_t>(n);
      // When the service ends the clock is not set back any more: its end has a bound.
      if (!lifecycle_.cancelled) deadline = Clock::now() + bounds_.stall;
      continue;
    }
    if (n < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR) return false;
    const auto from = Clock::now();
    if (from >= deadline || wait_for(socket_, POLLOUT, std::min(glance, left(deadline))) < 0) return false;
    blocked_ += Clock::now() - from;
    const std::chrono::duration<double> drips = blocked_;
    if (blocked_ > bounds_.drip && static_cast<double>(taken_) < bounds_.rate * drips.count()) return false;
  }
  return true;
}

void Connection::linger() {
  ::shutdown(socket_, SHUT_WR);
  const auto deadline = Clock::now() + std::chrono::seconds(1);
  while (!lifecycle_.cancelled && fill(deadline)) buffer_.clear();
}

}  // namespace least::server
