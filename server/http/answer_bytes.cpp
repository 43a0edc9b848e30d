#include "server/http/answer_bytes.hpp"

#include <charconv>

#include "server/shared/http_status.hpp"

namespace least::server {

std::string head_of(const Answer& answer, bool keep_alive, bool chunked) {
  std::string head;
  head.reserve(1024 + answer.body.size());
  ((head += "HTTP/1.1 ") += std::to_string(answer.status)) += ' ';
  head += phrase(answer.status);
  head += "\r\n";
  const auto field = [&](std::string_view name, std::string_view value) {
    ((head += name) += ": ") += value;
    head += "\r\n";
  };
  if (!answer.type.empty()) field("Content-Type", answer.type);
  if (chunked) {
    field("Transfer-Encoding", "chunked");
  } else if (!answer.stream && !answer.pieces && answer.status != 204 && answer.status != 304) {
    field("Content-Length", std::to_string(answer.body.size()));
  }
  for (const auto& [name, value] : answer.headers) field(name, value);
  field("Connection", keep_alive ? "keep-alive" : "close");
  return head += "\r\n";
}

std::string chunk_of(std::string_view piece, bool chunked) {
  if (!chunked || piece.empty()) return std::string(piece);  // an empty chunk would end the body
  char size[16];
  std::string chunk(size, std::to_chars(size, size + sizeof size, piece.size(), 16).ptr);
  chunk.reserve(chunk.size() + piece.size() + 4);
  return ((chunk += "\r\n") += piece) += "\r\n";
}

}  // namespace least::server
