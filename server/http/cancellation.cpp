#include "server/http/cancellation.hpp"

#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace least::server {
namespace {

constexpr std::chrono::milliseconds between_looks{50};

}  // namespace

// A single thread watches all computations: one thread each would cost as much as the rest of a short request.
class CancellationWatch::Watcher {
 public:
  static Watcher& instance() {
    static Watcher watcher;
    return watcher;
  }

  void add(CancellationWatch& watch) {
    {
      const std::lock_guard lock(mutex_);
      watches_.push_back(&watch);
      if (attended_ > 0) return;
      if (!thread_.joinable()) thread_ = std::jthread([this](const std::stop_token& stop) { work(stop); });
    }
    came_.notify_one();
  }
  void remove(CancellationWatch& watch) {
    const std::lock_guard lock(mutex_);
    std::erase(watches_, &watch);
  }
  void look() {
    const std::lock_guard lock(mutex_);
    for (CancellationWatch* watch : watches_) watch->look();
  }
  void attend(int more) {
    const std::lock_guard lock(mutex_);
    attended_ += more;
  }

 private:
  void work(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (came_.wait(lock, stop, [this] { return !watches_.empty(); }) && !stop.stop_requested()) {
      pause_.wait_for(lock, stop, between_looks, [] { return false; });
      for (CancellationWatch* watch : watches_) watch->look();
    }
  }

  std::mutex mutex_;
  std::condition_variable_any came_, pause_;
  std::vector<CancellationWatch*> watches_;
  int attended_ = 0;
  std::jthread thread_;  // last, as the thread uses the other members
};

CancellationWatch::Attended::Attended() { Watcher::instance().attend(1); }
CancellationWatch::Attended::~Attended() { Watcher::instance().attend(-1); }
void CancellationWatch::look_at_all() { Watcher::instance().look(); }

CancellationWatch::CancellationWatch(const std::atomic<bool>& ended, std::function<bool()> gone, double seconds)
    : ended_(ended), gone_(std::move(gone)), seconds_(seconds) {
  Watcher::instance().add(*this);
}
CancellationWatch::~CancellationWatch() { Watcher::instance().remove(*this); }

void CancellationWatch::look() {
  const auto passed = Clock::now() - start_;
  if (cancelled_ || passed < between_looks) return;
  const bool late = std::chrono::duration<double>(passed).count() > seconds_;
  if (!late && !ended_ && !(gone_ && gone_())) return;
  timed_out_ = late;
  cancelled_ = true;
}

}  // namespace least::server
