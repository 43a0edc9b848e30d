#include "server/http/answer_writer.hpp"

#include <chrono>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include "server/http/answer_bytes.hpp"

namespace least::server {
namespace {

// A client that has not made room after this time is slower than the computation.
constexpr std::chrono::milliseconds soon{10};

}  // namespace

void AnswerWriter::finish(Exchange& exchange, std::string last, bool keeps) {
  exchange.over = Exchange::Clock::now();
  exchange.outbox.finish(true, std::move(last), keeps);
}

void AnswerWriter::stream(Exchange& exchange, const Answer& answer, std::string head) {
  std::optional<std::string> end;
  if (exchange.outbox.put(std::move(head))) {
    end = answer.stream([&](std::string_view piece) {
      if (piece.empty()) return !exchange.left;
      exchange.bytes += piece.size();
      std::string chunk = chunk_of(piece, exchange.chunked);
      return (exchange.outbox.await_room(soon) || let_others(exchange)) && exchange.outbox.put(std::move(chunk));
    });
  }
  exchange.computing = false;
  if (!end) return exchange.outbox.finish(false);
  exchange.bytes += end->size();
  finish(exchange, chunk_of(*end, exchange.chunked).append(end_of_chunks(exchange.chunked)));
}

// let_others lends place and thread to others until the client has taken what is there. False: the client is gone, the
// service ends, or no thread can be had for others; then the run ends.
bool AnswerWriter::let_others(Exchange& exchange) {
  if (!workers_.step_aside()) return false;
  const std::shared_ptr<void> back(nullptr, [this](void*) { workers_.step_back(); });
  const bool parked = admission_.park(exchange.place);
  exchange.outbox.await_room();
  return !parked || admission_.resume(exchange.place, [&exchange] { return exchange.left.load(); });
}

void AnswerWriter::write_pieces(Exchange& exchange) {
  do {
    std::string piece;
    while (exchange.has_pieces && exchange.outbox.has_room()) {
      piece.clear();
      const bool more = exchange.pieces(piece);
      exchange.bytes += piece.size();
      std::string chunk = chunk_of(piece, exchange.chunked);
      if (!more) {
        exchange.has_pieces = false;
        exchange.pieces = nullptr;  // freed before the client can have read the end
        return finish(exchange, std::move(chunk += end_of_chunks(exchange.chunked)));
      }
      if (exchange.outbox.put(std::move(chunk))) continue;
      exchange.has_pieces = false;
      exchange.pieces = nullptr;
    }
    exchange.writing = false;
  } while (exchange.has_pieces && exchange.outbox.has_room() && !exchange.writing.exchange(true));
}

}  // namespace least::server
