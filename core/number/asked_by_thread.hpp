// AskedByThread lets a long computation ask, deep inside and on its own thread, whether it should go on.
#pragma once

#include <functional>
#include <utility>

namespace least {

/// While an AskedByThread lives, computations on its thread ask it now and then whether to go on; of several, the one
/// made last is asked. A computation that is told no ends without a result; its caller knows the reason.
class AskedByThread {
 public:
  /// `goes_on` must not throw, and once it has returned false it must not return true again.
  explicit AskedByThread(std::function<bool()> goes_on)
      : goes_on_(std::move(goes_on)), before_(std::exchange(current(), this)) {}
  ~AskedByThread() { current() = before_; }
  AskedByThread(const AskedByThread&) = delete;
  AskedByThread& operator=(const AskedByThread&) = delete;

  /// Asks whether to go on; true where no AskedByThread lives on this thread.
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
