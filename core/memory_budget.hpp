// The memory that all requests of a process share, and what each of them holds of it. What a request makes is counted
// before it is made, and given back where that ends.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <new>
#include <utility>
#include <vector>

namespace least {

/// Bytes that all together may hold. Safe from any thread.
class MemoryBudget {
 public:
  explicit MemoryBudget(std::size_t bytes) : most_(bytes) {}

  /// False, and nothing taken, where it would be too much.
  bool take(std::size_t bytes) {
    std::size_t held = held_;
    do {
      if (bytes > most_ || held > most_ - bytes) return false;
    } while (!held_.compare_exchange_weak(held, held + bytes));
    return true;
  }
  void give_back(std::size_t bytes) { held_ -= bytes; }
  std::size_t held() const { return held_; }
  std::size_t most() const { return most_; }

  /// For those who wait for others to give back: whether this one is to give up, after so many seconds. One does at a
  /// time, and then the others have another moment: what it gives back may be what they wait for.
  bool gives_up(double waited);

 private:
  const std::size_t most_;
  std::atomic<std::size_t> held_{0};
  std::atomic<double> gave_up_{-1e9};  ///< when somebody last did, by steady_seconds
};

/// The budget has no more room.
struct MemoryShortage : std::bad_alloc {
  const char* what() const noexcept override { return "no room in the memory that all requests share"; }
};

/// What one of them holds, given back at its end.
class Held {
 public:
  /// `budget` may be null: no bound.
  explicit Held(MemoryBudget* budget = nullptr) : budget_(budget) {}
  Held(Held&& other) noexcept : budget_(other.budget_), bytes_(std::exchange(other.bytes_, 0)) {}
  Held& operator=(Held&& other) noexcept {
    std::swap(budget_, other.budget_);
    std::swap(bytes_, other.bytes_);
    return *this;
  }
  ~Held() {
    if (budget_) budget_->give_back(bytes_);
  }

  std::size_t bytes() const { return bytes_; }
  /// At least so many bytes. False, and no more than before, where there are not so many.
  bool grow_to(std::size_t bytes) {
    if (bytes <= bytes_ || !budget_) return true;
    if (!budget_->take(bytes - bytes_)) return false;
    bytes_ = bytes;
    return true;
  }
  /// The same of this budget, where it held of none.
  bool grow_to(MemoryBudget* budget, std::size_t bytes) {
    if (!budget_) budget_ = budget;
    return grow_to(bytes);
  }
  bool grow_by(std::size_t bytes) { return grow_to(bytes_ + bytes); }
  /// So many bytes more; throws MemoryShortage.
  void add(std::size_t bytes) {
    if (!grow_by(bytes)) throw MemoryShortage();
  }
  /// The same, where others may be about to give back: waits for that, for a moment, as long as its thread's
  /// computation is to go on.
  void add_soon(std::size_t bytes);
  void shrink_to(std::size_t bytes) { shrink_by(bytes_ - std::min(bytes, bytes_)); }
  void shrink_by(std::size_t bytes) {
    bytes = std::min(bytes, bytes_);
    if (!budget_) return;
    budget_->give_back(bytes);
    bytes_ -= bytes;
  }

 private:
  MemoryBudget* budget_;
  std::size_t bytes_ = 0;
};

/// Room for so many numbers in a list that grows, held before it is taken; throws MemoryShortage.
template <class T>
void make_room(std::vector<T>& list, std::size_t size, Held& held) {
  const std::size_t before = list.capacity(), after = std::max(size, before + before / 2);
  if (size <= before) return;
  held.add(after * sizeof(T));
  list.reserve(after);
  held.shrink_by(before * sizeof(T));
}

/// While it lives, what its thread derives from a scene is held of this budget: how much that is shows deep in a
/// computation.
class HeldByThread {
 public:
  explicit HeldByThread(MemoryBudget* budget) : before_(std::exchange(current(), budget)) {}
  ~HeldByThread() { current() = before_; }
  HeldByThread(const HeldByThread&) = delete;
  HeldByThread& operator=(const HeldByThread&) = delete;

  /// The thread's budget; null: no bound.
  static MemoryBudget* budget() { return current(); }
  /// So many bytes of it; throws MemoryShortage.
  static Held take(std::size_t bytes) {
    Held held(current());
    held.add(bytes);
    return held;
  }
  static Held take_soon(std::size_t bytes) {
    Held held(current());
    held.add_soon(bytes);
    return held;
  }

 private:
  static MemoryBudget*& current() {
    thread_local MemoryBudget* budget = nullptr;
    return budget;
  }

  MemoryBudget* before_;
};

}  // namespace least
