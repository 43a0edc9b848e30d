// Whether what takes long is to go on: asked deep in a computation, on its thread.
#pragma once

#include <functional>
#include <utility>

namespace least {

/// While it lives, computations of its thread ask it now and then whether they are to go on; of those that live, the
/// last one is asked. Who is told no ends without a result: whoever waits for that has the reason.
class AskedByThread {
 public:
  /// `goes_on` throws nothing, and once it has said no it says nothing else.
  explicit AskedByThread(std::function<bool()> goes_on)
      : goes_on_(std::move(goes_on)), before_(std::exchange(current(), this)) {}
  ~AskedByThread() { current() = before_; }
  AskedByThread(const AskedByThread&) = delete;
  AskedByThread& operator=(const AskedByThread&) = delete;

  /// True where there is nobody to be asked.
  static bool goes_on() { return !current() || current()->goes_on_(); }

 private:
  static const AskedByThread*& current() {
    thread_local const AskedByThread* asked = nullptr;
    return asked;
  }

  const std::function<bool()> goes_on_;
  const AskedByThread* const before_;
};

}  // namespace least
