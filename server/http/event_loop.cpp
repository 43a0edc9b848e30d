#include "server/http/event_loop.hpp"

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <system_error>
#include <utility>

#include "server/http/forwarded.hpp"
#include "server/shared/log.hpp"

namespace least::server {
namespace {

constexpr std::chrono::milliseconds between_ticks{50};
constexpr std::uint64_t called = 2;  // smaller numbers stand for the doors

void check(int result) {
  if (result < 0) throw std::system_error(errno, std::generic_category());
}

// add_to returns a negative number, with errno set, where the system has no room for one more descriptor.
int add_to(int epoll, int descriptor, std::uint32_t events, std::uint64_t id) {
  epoll_event event{events, {}};
  event.data.u64 = id;
  return ::epoll_ctl(epoll, EPOLL_CTL_ADD, descriptor, &event);
}

// contained runs act(), and logs an exception as far as memory allows. False: there was an exception.
template <class Act>
bool contained(std::string_view event, Act&& act) {
  try {
    act();
    return true;
  } catch (const std::exception& e) {
    try {
      LogLine(spdlog::level::err, event).with("why", e.what());
    } catch (...) {
    }
  } catch (...) {
  }
  return false;
}
constexpr std::string_view lost = "connection lost";

// text_of returns an address without its port; empty for an unknown family.
std::string text_of(const sockaddr_storage& address) {
  char text[INET6_ADDRSTRLEN] = "";
  const void* number = nullptr;
  if (address.ss_family == AF_INET) number = &reinterpret_cast<const sockaddr_in&>(address).sin_addr;
  if (address.ss_family == AF_INET6) number = &reinterpret_cast<const sockaddr_in6&>(address).sin6_addr;
  if (number == nullptr || ::inet_ntop(address.ss_family, number, text, sizeof text) == nullptr) return {};
  return address_of(text);
}

int port_of(int socket) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  if (::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size) != 0) return 0;
  return ntohs(address.ss_family == AF_INET6 ? reinterpret_cast<const sockaddr_in6&>(address).sin6_port
                                             : reinterpret_cast<const sockaddr_in&>(address).sin_port);
}

}  // namespace

EventLoop::EventLoop(std::size_t most, const ConnectionBounds& bounds, Lifecycle& lifecycle, Handler& handler)
    : most_(most),
      bounds_(bounds),
      lifecycle_(lifecycle),
      handler_(handler),
      epoll_(::epoll_create1(EPOLL_CLOEXEC)),
      wake_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  check(epoll_);
  check(wake_);
  check(add_to(epoll_, wake_, EPOLLIN | EPOLLET, called));
}

EventLoop::~EventLoop() {
  connections_.clear();
  for (const int descriptor : {doors_[0].socket, doors_[1].socket, wake_, epoll_}) {
    if (descriptor >= 0) ::close(descriptor);
  }
}

std::optional<std::string> EventLoop::listen(const std::string& host, int port, bool for_metrics) {
  auto& [listener, its_port] = doors_[for_metrics ? 1 : 0];
  addrinfo hints{}, *found = nullptr;
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  if (const int error = ::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found); error != 0) {
    return ::gai_strerror(error);
  }
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> addresses(found, ::freeaddrinfo);
  int error = 0;
  for (const addrinfo* address = found; address != nullptr; address = address->ai_next) {
    listener = ::socket(address->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    const int yes = 1;
    if (listener >= 0 && ::setsockopt(listener, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes) == 0 &&
        ::bind(listener, address->ai_addr, address->ai_addrlen) == 0 && ::listen(listener, SOMAXCONN) == 0 &&
        add_to(epoll_, listener, EPOLLIN, for_metrics ? 1 : 0) == 0) {
      its_port = port_of(listener);
      return std::nullopt;
    }
    error = errno;  // of the first call that failed
    if (listener >= 0) ::close(std::exchange(listener, -1));
  }
  return std::strerror(error);
}

void EventLoop::run(const std::function<void()>& tick_too) {
  thread_ = std::this_thread::get_id();
  while (!turn() || handler_.busy()) {
    const auto now = Clock::now();
    if (now - ticked_ < between_ticks) continue;
    ticked_ = now;
    tick(now);
    contained("failed", tick_too);
  }
}

void EventLoop::wake() noexcept { call(called); }

// call(id) requests a look at a connection. The loop checks its calls before it sleeps, so that only the first call of
// another thread has to wake it. Where there is no memory for a call, the next tick looks at the connection.
void EventLoop::call(Id id) noexcept {
  try {
    const std::lock_guard lock(mutex_);
    calls_.push_back(id);
    if (calls_.size() > 1) return;
  } catch (const std::bad_alloc&) {
    return;
  }
  if (std::this_thread::get_id() == thread_.load()) return;
  const std::uint64_t one = 1;
  (void)!::write(wake_, &one, sizeof one);
}

// turn() waits for events and handles them. True: all is over.
bool EventLoop::turn() {
  int patience = static_cast<int>(between_ticks.count());
  {
    const std::lock_guard lock(mutex_);
    if (!calls_.empty()) patience = 0;
  }
  std::array<epoll_event, 256> events;
  const int n = ::epoll_wait(epoll_, events.data(), static_cast<int>(events.size()), patience);
  for (int i = 0; i < n; ++i) {
    const epoll_event& event = events[static_cast<std::size_t>(i)];
    if (event.data.u64 < doors_.size()) {
      accept(doors_[event.data.u64]);
    } else if (event.data.u64 == called) {
      std::uint64_t count;
      (void)!::read(wake_, &count, sizeof count);
    } else {
      advance(event.data.u64, event.events);
    }
  }
  {
    const std::lock_guard lock(mutex_);
    called_.clear();
    called_.swap(calls_);
  }
  for (const Id id : called_) advance(id, 0);
  if (lifecycle_.draining) {
    for (Door& door : doors_) {
      if (door.socket < 0) continue;
      accept(door);  // connections that came before the end
      ::close(std::exchange(door.socket, -1));
    }
  }
  if (paused_ && connections_.size() < full_size_) watch(true);
  count_ = connections_.size();
  return doors_[0].socket < 0 && connections_.empty();
}

void EventLoop::tick(Clock::time_point now) {
  for (auto entry = connections_.begin(); entry != connections_.end();) {
    Connection& connection = entry->second;
    const bool lives = contained(lost, [&] { connection.tick(now); }) && !connection.closed();
    entry = lives ? std::next(entry) : connections_.erase(entry);
  }
  if (paused_) watch(true);
}

void EventLoop::advance(Id id, unsigned events) {
  const auto found = connections_.find(id);
  if (found == connections_.end()) return;
  Connection& connection = found->second;
  const bool good = contained(lost, [&] {
    connection.note(events);
    if (!connection.closed()) connection.advance();
  });
  if (!good || connection.closed()) connections_.erase(found);
}

bool EventLoop::somebody_waits(const Door& door) {
  pollfd queue{door.socket, POLLIN, 0};
  return door.socket >= 0 && ::poll(&queue, 1, 0) == 1;
}

// Connections are closed only for clients that are waiting, not for possible ones: accept fails without descriptors
// even when nobody waits.
void EventLoop::accept(Door& door) {
  while (somebody_waits(door)) {
    if (connections_.size() >= most_ && !make_room()) return watch(false);
    sockaddr_storage address{};
    socklen_t size = sizeof address;
    const int socket =
        ::accept4(door.socket, reinterpret_cast<sockaddr*>(&address), &size, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (socket >= 0) {
      add(socket, address, &door != &doors_[0]);
      continue;
    }
    if (errno == EAGAIN || errno == EWOULDBLOCK) return;
    if (errno == EINTR || errno == ECONNABORTED) continue;
    // No descriptor or memory is left for one more.
    if (!make_room()) return watch(false);
  }
}

void EventLoop::add(int socket, const sockaddr_storage& address, bool for_metrics) {
  const int yes = 1;
  ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  ::setsockopt(socket, SOL_SOCKET, SO_SNDBUF, &bounds_.send_buffer, sizeof bounds_.send_buffer);
  const Id id = ++last_;
  const bool good = contained(lost, [&] {
    Peer peer{text_of(address), for_metrics, nullptr};
    peer.account = std::make_shared<Account>(peer.address);
    connections_.try_emplace(id, socket, std::move(peer), bounds_, lifecycle_, handler_, [this, id] { call(id); });
    check(add_to(epoll_, socket, EPOLLIN | EPOLLOUT | EPOLLRDHUP | EPOLLET, id));
  });
  if (!good && connections_.erase(id) == 0) ::close(socket);
}

// make_room closes the connection that has been idle longest, or else the one whose request has been missing longest.
bool EventLoop::make_room() {
  const auto now = Clock::now();
  auto first = connections_.end();
  decltype(first->second.makes_room(now)) rank;
  for (auto entry = connections_.begin(); entry != connections_.end(); ++entry) {
    const auto other = entry->second.makes_room(now);
    if (!other || (rank && *rank <= *other)) continue;
    first = entry;
    rank = other;
  }
  if (first == connections_.end()) return false;
  connections_.erase(first);
  return true;
}

// While no connection can be accepted, those waiting outside are not polled, and those inside are asked to leave.
void EventLoop::watch(bool accepting) {
  paused_ = !accepting;
  full_size_ = connections_.size();
  lifecycle_.crowded = paused_;
  for (std::size_t i = 0; i < doors_.size(); ++i) {
    if (doors_[i].socket < 0) continue;
    epoll_event event{accepting ? std::uint32_t{EPOLLIN} : 0, {}};
    event.data.u64 = i;
    (void)::epoll_ctl(epoll_, EPOLL_CTL_MOD, doors_[i].socket, &event);
  }
}

}  // namespace least::server
