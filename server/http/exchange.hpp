// One request and its answer, between the loop that owns the connection and the thread that is at work on it.
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
  std::atomic<bool> left{false};       ///< its client went away
  std::atomic<bool> computing{false};  ///< it waits for its turn, or has it
  Admission::Ticket place{};           ///< of what is computed while it leaves

  // Written by who answers, before the first byte is put.
  std::string_view route;
  int status = 0;
  bool keep_alive = false;
  bool chunked = false, bare = false;                ///< its body; bare: nothing but its connection's end marks its end
  std::string_view begins{};                         ///< each piece of it, where that is known
  std::shared_ptr<const std::vector<Note>> notes{};  ///< for the log; more of them at the end of a stream
  std::atomic<std::size_t> bytes{0};                 ///< of the body
  /// The rest of a body that is written when there is room for it, by one thread at a time.
  std::function<bool(std::string&)> pieces{};
  std::atomic<bool> has_pieces{false}, writing{false};

  Clock::time_point over{};  ///< when the last of it was there to be sent, or left after that
  bool sent = false;         ///< all of it, to a client that took it; for the loop

  /// What is done once, when all is over. May not throw.
  std::function<void(const Exchange&)> ended{};
  void end() {
    outbox.release();
    if (const auto told = std::exchange(ended, nullptr)) told(*this);
  }
};
using ExchangePtr = std::shared_ptr<Exchange>;

}  // namespace least::server
