#include "server/http/listener.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>

namespace least::server {
namespace {

// The library's pool, with a count of the connections that wait for a thread.
class Pool final : public httplib::TaskQueue {
 public:
  Pool(std::size_t threads, std::atomic<int>& waiting) : pool_(threads), waiting_(waiting) {}

  // Newer releases of the library say whether the task was taken.
  using Taken = decltype(std::declval<httplib::TaskQueue&>().enqueue({}));
  Taken enqueue(std::function<void()> task) override {
    ++waiting_;
    return pool_.enqueue([this, task = std::move(task)] {
      --waiting_;
      task();
    });
  }
  void shutdown() override { pool_.shutdown(); }

 private:
  httplib::ThreadPool pool_;
  std::atomic<int>& waiting_;
};

}  // namespace

Listener::Listener(std::size_t threads, std::atomic<int>& waiting, std::function<void(int)> serve)
    : serve_(std::move(serve)) {
  new_task_queue = [threads, &waiting] { return new Pool(threads, waiting); };
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
