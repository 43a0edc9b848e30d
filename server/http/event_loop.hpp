// The listening socket and one thread for all connections: it takes requests off them until they are whole, and lets
// answers leave, and waits only for all of them at once. Whatever a client does or does not do holds up nobody else.
//
// cpp-httplib is not used here. It gives a thread to every connection and blocks in it, in all of its releases, so that
// slow clients are paid for with threads; and the release in Debian 12 cannot close a connection whose request it
// refused, keeps headers and chunked bodies without bound, and believes contradictory lengths.
//
// How answers leave. What is in memory, or kept as numbers (a finished run), is written in pieces while the socket
// takes them, by a worker that goes back as soon as some hundred kilobytes are ready: a slow reader holds that much and
// no thread. Only what is computed while it leaves (lines of a run, a study, an ensemble) is not kept: there the worker
// waits for its client, within the limits of its run and no longer than `drip` allows, steps aside, and lends its place
// to compute to others until it can go on; for the end of it, once that place is given back, it does not wait.
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

class EventLoop {
 public:
  /// `most` connections at once. Where there are as many, or the system gives no more, and somebody waits, one that
  /// idles makes room, or else one whose request does not come. Throws where the system has not what it takes.
  EventLoop(std::size_t most, const ConnectionBounds& bounds, Lifecycle& lifecycle, Handler& handler);
  ~EventLoop();
  EventLoop(const EventLoop&) = delete;
  EventLoop& operator=(const EventLoop&) = delete;

  /// Binds and begins to queue connections; `for_metrics`: for those alone. On failure: why, in the system's words.
  std::optional<std::string> listen(const std::string& host, int port, bool for_metrics = false);
  int port() const { return doors_[0].port; }
  int metrics_port() const { return doors_[1].port; }
  std::size_t connections() const { return count_; }

  /// Serves until the service drains and all connections are closed. Calls `tick` every 50 ms. What is thrown meanwhile
  /// is logged, and costs the connection with which it happened.
  void run(const std::function<void()>& tick);

  /// Something happened that the loop has to look at. From any thread.
  void wake() noexcept;

 private:
  using Clock = Connection::Clock;
  using Id = std::uint64_t;

  // Where clients come in.
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
  std::array<Door, 2> doors_;  // the second for metrics alone
  bool paused_ = false;        // nobody is let in for the moment
  std::size_t full_size_ = 0;  // connections that there were then
  std::unordered_map<Id, Connection> connections_;
  std::atomic<std::size_t> count_{0};  // of them, for others to read
  Id last_ = 2;                        // smaller ones stand for the doors and for calls
  Clock::time_point ticked_ = Clock::now();
  std::atomic<std::thread::id> thread_{};
  std::mutex mutex_;
  std::vector<Id> calls_, called_;  // connections for which something came
};

}  // namespace least::server
