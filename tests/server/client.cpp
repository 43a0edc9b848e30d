#include "tests/server/client.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <utility>

namespace least::server::test {

Client::Client(int port, const char* from, int buffer) {
  socket_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const timeval patience{20, 0};
  ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  ::setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
  if (buffer > 0) ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &buffer, sizeof buffer);
  sockaddr_in address{};
  if (from) {
    address.sin_family = AF_INET;
    ::inet_pton(AF_INET, from, &address.sin_addr);
    ::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address);
  }
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    ::close(std::exchange(socket_, -1));
  }
}

Client::~Client() {
  if (socket_ >= 0) ::close(socket_);
}

Client::Client(Client&& other) noexcept
    : socket_(std::exchange(other.socket_, -1)), buffer_(std::move(other.buffer_)) {}

bool Client::send(std::string_view bytes) {
  while (!bytes.empty()) {
    const auto n = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (n <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
  return true;
}

void Client::end_sending() { ::shutdown(socket_, SHUT_WR); }

void Client::hang_up() { ::close(std::exchange(socket_, -1)); }

void Client::reset() {
  const linger at_once{1, 0};
  ::setsockopt(socket_, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
  ::close(std::exchange(socket_, -1));
}

bool Client::fill(std::size_t most) {
  char bytes[65536];
  const auto n = ::recv(socket_, bytes, std::min(most, sizeof bytes), 0);
  if (n > 0) buffer_.append(bytes, static_cast<std::size_t>(n));
  return n > 0;
}

int Client::interim() {
  std::size_t end;
  while ((end = buffer_.find("\r\n\r\n")) == std::string::npos) {
    if (!fill()) return 0;
  }
  const int status = std::stoi(buffer_.substr(9, 3));
  buffer_.erase(0, end + 4);
  return status;
}

std::optional<Reply> Client::receive(bool head) {
  std::size_t end;
  while ((end = buffer_.find("\r\n\r\n")) == std::string::npos) {
    if (!fill()) return std::nullopt;
  }
  Reply reply;
  reply.status = std::stoi(buffer_.substr(9, 3));
  for (std::size_t at = buffer_.find("\r\n") + 2; at < end + 2;) {
    const auto stop = buffer_.find("\r\n", at), colon = buffer_.find(": ", at);
    std::string name = buffer_.substr(at, colon - at);
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
    reply.fields[name] = buffer_.substr(colon + 2, stop - colon - 2);
    at = stop + 2;
  }
  buffer_.erase(0, end + 4);
  if (head || reply.status < 200 || reply.status == 204 || reply.status == 304) return reply;
  if (reply.fields.contains("transfer-encoding")) {
    for (;;) {
      const auto piece = chunk();
      if (!piece) return std::nullopt;
      if (piece->empty()) return reply;
      reply.chunks.push_back(*piece);
      reply.body += *piece;
    }
  }
  const auto length = std::stoul(reply.fields.at("content-length"));
  while (buffer_.size() < length) {
    if (!fill()) return std::nullopt;
  }
  reply.body = buffer_.substr(0, length);
  buffer_.erase(0, length);
  return reply;
}

std::optional<std::string> Client::chunk() {
  std::size_t line;
  while ((line = buffer_.find("\r\n")) == std::string::npos) {
    if (!fill()) return std::nullopt;
  }
  std::size_t digits = 0;
  const auto length = std::stoul(buffer_, &digits, 16);
  if (digits != line) return std::nullopt;
  while (buffer_.size() < line + length + 4) {
    if (!fill()) return std::nullopt;
  }
  if (buffer_.compare(line + 2 + length, 2, "\r\n") != 0) return std::nullopt;
  std::string piece = buffer_.substr(line + 2, length);
  buffer_.erase(0, line + length + 4);
  return piece;
}

std::optional<std::string> Client::some(std::size_t most) {
  if (buffer_.empty() && !fill(most)) return std::nullopt;
  return std::exchange(buffer_, {});
}

std::string_view Client::peek() {
  if (buffer_.empty()) fill();
  return buffer_;
}

bool Client::ended() {
  if (!buffer_.empty()) return false;
  char byte;
  return ::recv(socket_, &byte, 1, 0) == 0;
}

bool Client::ends_by_reset() {
  char bytes[65536];
  ssize_t n;
  while ((n = ::recv(socket_, bytes, sizeof bytes, 0)) > 0) {
  }
  return n < 0 && errno == ECONNRESET;
}

std::string get(std::string_view path, std::string_view fields) {
  return "GET " + std::string(path) + " HTTP/1.1\r\nHost: localhost\r\n" + std::string(fields) + "\r\n";
}

std::string post(std::string_view path, std::string_view body, std::string_view fields) {
  return "POST " + std::string(path) + " HTTP/1.1\r\nHost: localhost\r\n" + std::string(fields) +
         "Content-Length: " + std::to_string(body.size()) + "\r\n\r\n" + std::string(body);
}

Reply ask(int port, std::string_view bytes, bool head) {
  Client client(port);
  if (!client.connected() || !client.send(bytes)) return {};
  return client.receive(head).value_or(Reply{});
}

}  // namespace least::server::test
