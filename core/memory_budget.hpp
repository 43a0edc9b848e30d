// The memory that all requests of a process share, and how much of it each of them holds. A request counts memory
// before it allocates it, and gives it back when it frees it.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <new>
#include <utility>
#include <vector>

namespace least {

/// MemoryBudget bounds the bytes that all requests together may hold. Any thread may call it.
class MemoryBudget {
 public:
  explicit MemoryBudget(std::size_t bytes) : most_(bytes) {}

  /// Takes so many bytes; returns false, and takes none, where the bound would be exceeded.
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

  /// gives_up(waited) says whether a caller that has waited so many seconds for memory is to give up. After half a
  /// second of patience callers give up one at a time, a moment apart: what one of them gives back may be what the
  /// others wait for.
  bool gives_up(double waited);

 private:
  const std::size_t most_;
  std::atomic<std::size_t> held_{0};
  std::atomic<double> gave_up_{-1e9};  ///< when a caller last gave up, by steady_seconds
};

/// MemoryShortage is thrown where the budget does not allow an allocation.
struct MemoryShortage : std::bad_alloc {
  const char* what() const noexcept override { return "no room in the memory that all requests share"; }
};

/// Held is the part of the budget that one owner holds; its destructor gives it back.
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
  /// Holds at least so many bytes. Returns false, and holds no more than before, where the budget does not allow that.
  bool grow_to(std::size_t bytes) {
    if (bytes <= bytes_ || !budget_) return true;
    if (!budget_->take(bytes - bytes_)) return false;
    bytes_ = bytes;
    return true;
  }
  /// The same; a Held without a budget takes this one first.
  bool grow_to(MemoryBudget* budget, std::size_t bytes) {
    if (!budget_) budget_ = budget;
    return grow_to(bytes);
  }
  bool grow_by(std::size_t bytes) { return grow_to(bytes_ + bytes); }
  /// Holds so many bytes more; throws MemoryShortage.
  void add(std::size_t bytes) {
    if (!grow_by(bytes)) throw MemoryShortage();
  }
  /// The same, but waits a moment where other requests may give memory back, unless the computation of its thread is to
  /// end (AskedByThread). Throws MemoryShortage.
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

/// make_room reserves room for `size` elements in a growing list and counts the bytes in `held` first; throws
/// MemoryShortage.
template <class T>
void make_room(std::vector<T>& list, std::size_t size, Held& held) {
  const std::size_t before = list.capacity(), after = std::max(size, before + before / 2);
  if (size <= before) return;
  held.add(after * sizeof(T));
  list.reserve(after);
  held.shrink_by(before * sizeof(T));
}

/// While a HeldByThread lives, memory for what its thread derives from a scene is taken from this budget. The budget is
/// thread-local because the amount is known only deep in a computation.
class HeldByThread {
 public:
  explicit HeldByThread(MemoryBudget* budget) : before_(std::exchange(current(), budget)) {}
  ~HeldByThread() { current() = before_; }
  HeldByThread(const HeldByThread&) = delete;
  HeldByThread& operator=(const HeldByThread&) = delete;

  /// The thread's budget; null: no bound.
  static MemoryBudget* budget() { return current(); }
  /// Takes so many bytes of the thread's budget; throws MemoryShortage.
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
