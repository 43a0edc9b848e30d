#include "server/http/listener.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <condition_variable>
#include <cstring>
#include <deque>
#include <mutex>
#include <system_error>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

#include "server/shared/log.hpp"

namespace least::server {
namespace {

// The library's pool makes all its threads at the start, and ends the process where it cannot have them all.
class Pool final : public httplib::TaskQueue {
 public:
  /// Throws where not even one thread can be had.
  Pool(std::size_t most, std::atomic<int>& waiting) : most_(most), waiting_(waiting) {
    const std::lock_guard lock(mutex_);
    grow();
  }
  ~Pool() override { end(); }

  // Newer releases of the library say whether the task was taken.
  using Taken = decltype(std::declval<httplib::TaskQueue&>().enqueue({}));
  Taken enqueue(std::function<void()> task) override {
    {
      const std::lock_guard lock(mutex_);
      tasks_.push_back(std::move(task));
      if (idle_ < tasks_.size() && threads_.size() < most_) grow();
      count();
    }
    came_.notify_one();
    return Taken(true);  // a cast to void is one, too
  }
  void shutdown() override { end(); }

 private:
  void grow() {
    try {
      threads_.emplace_back([this] { work(); });
    } catch (const std::system_error& e) {
      if (threads_.empty()) throw;
      most_ = threads_.size();  // tasks wait for those that there are
      LogLine(spdlog::level::warn, "no further thread")
          .with("threads", static_cast<std::int64_t>(most_))
          .with("why", e.what());
    }
  }
  // A thread on its way takes up a task by itself: only beyond the last do connections wait for one another.
  void count() { waiting_ = threads_.size() < most_ ? 0 : static_cast<int>(tasks_.size()); }
  void work() {
    std::unique_lock lock(mutex_);
    for (;;) {
      ++idle_;
      came_.wait(lock, [this] { return ended_ || !tasks_.empty(); });
      --idle_;
      if (tasks_.empty()) return;
      const auto task = std::move(tasks_.front());
      tasks_.pop_front();
      count();
      lock.unlock();
      task();
      lock.lock();
    }
  }
  void end() {
    {
      const std::lock_guard lock(mutex_);
      ended_ = true;
    }
    came_.notify_all();
    for (std::thread& thread : threads_)
      if (thread.joinable()) thread.join();
  }

  std::size_t most_;
  std::atomic<int>& waiting_;
  std::mutex mutex_;
  std::condition_variable came_;
  std::deque<std::function<void()>> tasks_;
  std::vector<std::thread> threads_;
  std::size_t idle_ = 0;
  bool ended_ = false;
};

}  // namespace

Listener::Listener(std::size_t threads, std::atomic<int>& waiting, std::function<void(int)> serve)
    : serve_(std::move(serve)), pool_(new Pool(threads, waiting)) {
  new_task_queue = [this] { return pool_.release(); };
  set_tcp_nodelay(true);
  // Not SO_REUSEPORT, the library's default: two services on one port would share its clients.
  set_socket_options([this](socket_t socket) {
    socket_ = socket;
    const int yes = 1;
    ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
}

std::optional<std::string> Listener::bind(const std::string& host, int port) {
  port_ = port == 0 ? bind_to_any_port(host) : bind_to_port(host, port) ? port : -1;
  // The library's queue of 5 drops clients who come together; listening again only makes it longer.
  if (port_ > 0 && ::listen(socket_, SOMAXCONN) == 0) return std::nullopt;
  return socket_ < 0 ? "no such address" : std::strerror(errno);
}

// The library's own stop() would also close the descriptor, which another thread may be about to use.
void Listener::close() { ::shutdown(socket_, SHUT_RDWR); }

bool Listener::process_and_close_socket(socket_t socket) {
  serve_(socket);
  ::close(socket);
  return true;
}

}  // namespace least::server
