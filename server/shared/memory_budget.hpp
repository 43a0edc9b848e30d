// The memory that requests and answers share, and what each of them holds of it.
#pragma once

#include <atomic>
#include <cstddef>
#include <utility>

namespace least::server {

/// Bytes that all together may hold. Safe from any thread.
class MemoryBudget {
 public:
  explicit MemoryBudget(std::size_t bytes) : most_(bytes) {}

  /// False, and nothing taken, where it would be too much.
  bool take(std::size_t bytes) {
    if (held_.fetch_add(bytes) + bytes <= most_) return true;
    held_ -= bytes;
    return false;
  }
  void give_back(std::size_t bytes) { held_ -= bytes; }
  std::size_t held() const { return held_; }
  std::size_t most() const { return most_; }

 private:
  const std::size_t most_;
  std::atomic<std::size_t> held_{0};
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

 private:
  MemoryBudget* budget_;
  std::size_t bytes_ = 0;
};

}  // namespace least::server
