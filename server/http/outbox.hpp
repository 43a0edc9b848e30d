// Bytes of an answer between the thread that makes them and the loop that sends them: so many at most, whatever the
// client's pace.
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

/// Where an answer goes: a socket that does not block, and what to call when there is something for who owns it.
struct Line {
  int socket;
  std::function<void()> came;
};

/// Bytes that an answer holds at most that is written while it leaves: what waits here, beyond its bound by a piece of
/// sixteen thousand numbers, as much on its way to the socket, and a compressor.
inline constexpr std::size_t most_of_a_stream = std::size_t{3} << 19;

class Outbox {
 public:
  explicit Outbox(Line line) : line_(std::move(line)) {}

  /// At least so many bytes count as memory until all is sent. False, and no more than before, where there are not so
  /// many.
  bool hold(MemoryBudget* budget, std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    return held_.grow_to(budget, bytes);
  }
  void release() {
    const std::lock_guard lock(mutex_);
    held_ = Held();
  }

  /// Waits while more than a bound is still to be sent, at most for so long. False: it still is.
  bool await_room(std::chrono::milliseconds most) {
    std::unique_lock lock(mutex_);
    return taken_.wait_for(lock, most, [this] { return closed_ || bytes_.size() < bound; });
  }
  /// Waits for that, however long: who sends keeps the clock.
  void await_room() {
    std::unique_lock lock(mutex_);
    taken_.wait(lock, [this] { return closed_ || bytes_.size() < bound; });
  }
  /// The same, and puts the bytes. False: nobody takes them any more.
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
  /// There is no more after `last`; `whole`: the answer has its end. Does not wait. An answer that is nothing but
  /// `last` is sent from here: then its owner hears of it with the next request (`keeps`: that the connection is for
  /// one).
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
  /// Whether `put` would not wait.
  bool has_room() {
    const std::lock_guard lock(mutex_);
    return closed_ || bytes_.size() < bound;
  }

  enum class State { open, whole, broken };
  /// Puts what there is in the place of `bytes`, and says whether more may come. `awaited`: the owner has something to
  /// do as soon as all is sent.
  State take(std::string& bytes, bool awaited) {
    const std::lock_guard lock(mutex_);
    awaited_ = awaited;
    bytes.clear();
    bytes.swap(bytes_);
    taken_.notify_one();
    return !ended_ ? State::open : whole_ ? State::whole : State::broken;
  }
  /// Whether the answer has its end, and all of it was taken.
  bool done() {
    const std::lock_guard lock(mutex_);
    return ended_ && whole_ && bytes_.empty();
  }
  /// Sends a word between, where nothing else is on its way.
  void interject(std::string_view word) {
    const std::lock_guard lock(mutex_);
    // To a client that has let a few bytes be in its way for so long, these do not matter either.
    if (!ended_ && bytes_.empty()) (void)!::send(line_.socket, word.data(), word.size(), MSG_NOSIGNAL);
  }
  /// Sends a further byte of what will be put next, where nothing else is on its way: it is known to begin with `text`.
  void send_ahead(std::string_view text) {
    const std::lock_guard lock(mutex_);
    if (ended_ || !bytes_.empty() || ahead_ >= text.size()) return;
    if (::send(line_.socket, &text[ahead_], 1, MSG_NOSIGNAL) == 1) ++ahead_;
  }
  /// Nobody takes any more, and the socket is not used.
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
  std::size_t ahead_ = 0;  // bytes of what is put next that were sent already
  bool begun_ = false, ended_ = false, whole_ = false, closed_ = false, awaited_ = false;
};

}  // namespace least::server
