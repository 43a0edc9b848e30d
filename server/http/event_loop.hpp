// The listening sockets and one thread for all connections: it reads requests until they are complete and sends
// answers, and waits for all connections at once, so that no client can hold up another.
//
// cpp-httplib is not used here. All of its releases block a thread per connection, so that slow clients cost threads;
// and the release in Debian 12 cannot close a connection whose request it refused, stores headers and chunked bodies
// without limit, and accepts contradictory lengths.
//
// How answers leave: what is in memory, or kept as numbers (a finished run), is written in pieces as the socket takes
// them, by a worker that returns once some hundred kilobytes are ready. A slow reader thus holds that much memory and
// no thread. Only what is computed while it is sent (lines of a run, a study, an ensemble) is not kept: there the
// worker waits for its client, within the limits of its run and of `drip`, steps aside, and lends its place to compute
// until it can go on. It does not wait for the end of the answer to be taken, once the place is given back.
#pragma once

#include <sys/socket.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <unordered_map>
#include <vector>

#include "server/http/connection.hpp"

namespace least::server {

/// EventLoop owns the listening sockets and all connections.
class EventLoop {
 public:
  /// `most` is the limit of connections. When it is reached, or the system refuses more, while somebody waits, an idle
  /// connection is closed, or else one whose request does not arrive. Throws where the system lacks resources.
  EventLoop(std::size_t most, const ConnectionBounds& bounds, Lifecycle& lifecycle, Handler& handler);
  ~EventLoop();
  EventLoop(const EventLoop&) = delete;
  EventLoop& operator=(const EventLoop&) = delete;

  /// listen binds and begins to queue connections; `for_metrics`: a port for metrics only. Returns an error in the
  /// system's words, or nothing.
  std::optional<std::string> listen(const std::string& host, int port, bool for_metrics = false);
  int port() const { return doors_[0].port; }
  int metrics_port() const { return doors_[1].port; }
  std::size_t connections() const { return count_; }

  /// run serves until the service drains and all connections are closed, and calls `tick` every 50 ms. An exception is
  /// logged and closes the connection that caused it.
  void run(const std::function<void()>& tick);

  /// wake() makes the loop look at its state; from any thread.
  void wake() noexcept;

 private:
  using Clock = Connection::Clock;
  using Id = std::uint64_t;

  // Door is a listening socket.
  struct Door {
    int socket = -1, port = 0;
  };

  bool turn();
  void tick(Clock::time_point now);
  void accept(Door& door);
  static bool somebody_waits(const Door& door);
  bool make_room();
  void watch(bool listening);
  void add(int socket, const sockaddr_storage& address, bool for_metrics);
  void advance(Id id, unsigned events);
  void call(Id id) noexcept;

  const std::size_t most_;
  const ConnectionBounds& bounds_;
  Lifecycle& lifecycle_;
  Handler& handler_;
  int epoll_ = -1, wake_ = -1;
  std::array<Door, 2> doors_;  // the second one is for metrics only
  bool paused_ = false;        // no connections are accepted at present
  std::size_t full_size_ = 0;  // the number of connections at that time
  std::unordered_map<Id, Connection> connections_;
  std::atomic<std::size_t> count_{0};  // their number, for other threads
  Id last_ = 2;                        // the numbers up to 2 stand for the doors and for calls
  Clock::time_point ticked_ = Clock::now();
  std::atomic<std::thread::id> thread_{};
  std::mutex mutex_;
  std::vector<Id> calls_, called_;  // connections for which something arrived
};

}  // namespace least::server
