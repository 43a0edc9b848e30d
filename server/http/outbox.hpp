// The bytes of an answer between the thread that makes them and the loop that sends them, limited whatever the client's
// speed.
#pragma once

#include <sys/socket.h>

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

#include "server/shared/memory_budget.hpp"

namespace least::server {

/// Line is the destination of an answer: a non-blocking socket, and a callback when its owner has something to do.
struct Line {
  int socket;
  std::function<void()> came;
};

/// The most memory of an answer that is written while it is sent: the bytes in the Outbox, which may exceed its bound
/// by a piece of sixteen thousand numbers, as much on its way to the socket, and a compressor.
inline constexpr std::size_t most_of_a_stream = std::size_t{3} << 19;

/// Outbox is used by one writing thread and the loop.
class Outbox {
 public:
  explicit Outbox(Line line) : line_(std::move(line)) {}

  /// hold charges at least so many bytes until all is sent. False, and no more is charged than before, where memory is
  /// short.
  bool hold(MemoryBudget* budget, std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    return held_.grow_to(budget, bytes);
  }
  void release() {
    const std::lock_guard lock(mutex_);
    held_ = Held();
  }

  /// await_room waits until less than the bound is unsent, for the given time at most. False: there still is no room.
  bool await_room(std::chrono::milliseconds most) {
    std::unique_lock lock(mutex_);
    return taken_.wait_for(lock, most, [this] { return closed_ || bytes_.size() < bound; });
  }
  /// The overload without a time waits as long as it takes: the sender watches the time limits.
  void await_room() {
    std::unique_lock lock(mutex_);
    taken_.wait(lock, [this] { return closed_ || bytes_.size() < bound; });
  }
  /// put waits for room and appends the bytes. False: nobody takes them any more.
  bool put(std::string bytes) {
    {
      std::unique_lock lock(mutex_);
      taken_.wait(lock, [this] { return closed_ || bytes_.size() < bound; });
      if (closed_) return false;
      without_ahead(bytes);
      const bool told = !bytes_.empty();
      begun_ = true;
      bytes_.empty() ? bytes_.swap(bytes) : (void)bytes_.append(bytes);
      if (told) return true;
    }
    line_.came();
    return true;
  }
  /// finish appends the end of the answer without waiting; `whole`: the answer is complete. An answer that consists
  /// only of `last` is sent at once by this thread; its owner then learns of it with the next request (`keeps`: the
  /// connection is kept for one).
  void finish(bool whole, std::string last = {}, bool keeps = false) {
    {
      const std::lock_guard lock(mutex_);
      std::size_t sent = 0;
      without_ahead(last);
      if (whole && !begun_ && !closed_) {
        const auto n = ::send(line_.socket, last.data(), last.size(), MSG_NOSIGNAL);
        sent = n > 0 ? static_cast<std::size_t>(n) : 0;
      }
      ended_ = true;
      whole_ = whole;
      if (sent == last.size() && bytes_.empty()) held_ = Held();
      if (sent == last.size() && keeps && !awaited_) return;
      if (sent > 0) last.erase(0, sent);
      bytes_.empty() ? bytes_.swap(last) : (void)bytes_.append(last);
    }
    line_.came();
  }
  /// has_room() tells whether `put` would not wait.
  bool has_room() {
    const std::lock_guard lock(mutex_);
    return closed_ || bytes_.size() < bound;
  }

  enum class State { open, whole, broken };
  /// take moves the bytes into `bytes`, and tells whether more may come. `awaited`: the owner has something to do as
  /// soon as all is sent.
  State take(std::string& bytes, bool awaited) {
    const std::lock_guard lock(mutex_);
    awaited_ = awaited;
    bytes.clear();
    bytes.swap(bytes_);
    taken_.notify_one();
    return !ended_ ? State::open : whole_ ? State::whole : State::broken;
  }
  /// done() tells whether the answer is complete and all of it was taken.
  bool done() {
    const std::lock_guard lock(mutex_);
    return ended_ && whole_ && bytes_.empty();
  }
  /// interject sends a word at once if nothing else is to be sent.
  void interject(std::string_view word) {
    const std::lock_guard lock(mutex_);
    // If the client has let a few bytes wait for so long, a lost word does not matter.
    if (!ended_ && bytes_.empty()) (void)!::send(line_.socket, word.data(), word.size(), MSG_NOSIGNAL);
  }
  /// send_ahead sends one more byte of the next piece, which is known to begin with `text`, if nothing else is to be
  /// sent.
  void send_ahead(std::string_view text) {
    const std::lock_guard lock(mutex_);
    if (ended_ || !bytes_.empty() || ahead_ >= text.size()) return;
    if (::send(line_.socket, &text[ahead_], 1, MSG_NOSIGNAL) == 1) ++ahead_;
  }
  /// close(): nobody takes bytes any more, and the socket is not used.
  void close() {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    bytes_ = {};
    held_ = Held();
    taken_.notify_one();
  }

 private:
  static constexpr std::size_t bound = 256 * 1024;

  void without_ahead(std::string& bytes) {
    if (ahead_ > 0) bytes.erase(0, std::exchange(ahead_, 0));
  }

  const Line line_;
  std::mutex mutex_;
  std::condition_variable taken_;
  std::string bytes_;
  Held held_{};
  std::size_t ahead_ = 0;  // bytes of the next piece that are sent already
  bool begun_ = false, ended_ = false, whole_ = false, closed_ = false, awaited_ = false;
};

}  // namespace least::server
