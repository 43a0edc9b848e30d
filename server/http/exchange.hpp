// One request and its answer, shared by the loop that owns the connection and the thread that works on it.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/http/admission.hpp"
#include "server/http/outbox.hpp"
#include "server/http/request_reader.hpp"
#include "server/shared/answer.hpp"

namespace least::server {

struct Exchange {
  using Clock = std::chrono::steady_clock;

  Exchange(Message request, std::string name, AccountPtr account, Line line)
      : message(std::move(request)), id(std::move(name)), client(std::move(account)), outbox(std::move(line)) {}
  ~Exchange() { end(); }
  Exchange(const Exchange&) = delete;
  Exchange& operator=(const Exchange&) = delete;

  const Message message;
  const std::string id;
  const AccountPtr client;
  const Clock::time_point start = Clock::now();
  Outbox outbox;
  std::atomic<bool> left{false};       ///< its client is gone
  std::atomic<bool> computing{false};  ///< it waits for its turn, or computes
  Admission::Ticket place{};           ///< of what is computed while it is sent

  // Written by the answering thread, before the first byte is put.
  std::string_view route;
  int status = 0;
  bool keep_alive = false;
  bool chunked = false, bare = false;  ///< of the body; bare: only the end of the connection marks its end
  std::string_view begins{};           ///< the beginning of each piece of the body, where that is known
  std::shared_ptr<const std::vector<Note>> notes{};  ///< for the log; a stream may add some at its end
  std::atomic<std::size_t> bytes{0};                 ///< sent so far, of the body
  /// The rest of a body that is written as there is room, by one thread at a time.
  std::function<bool(std::string&)> pieces{};
  std::atomic<bool> has_pieces{false}, writing{false};

  Clock::time_point over{};  ///< when its last byte was ready to be sent, or was sent later
  bool sent = false;         ///< all was sent, to a client that took it; for the loop

  /// Called once, when all is over. Must not throw.
  std::function<void(const Exchange&)> ended{};
  void end() {
    outbox.release();
    if (const auto told = std::exchange(ended, nullptr)) told(*this);
  }
};
using ExchangePtr = std::shared_ptr<Exchange>;

}  // namespace least::server
