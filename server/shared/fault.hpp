// Faults of a request, collected so that a client reads all of them at once.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace least::server {

/// One thing wrong with a request.
struct Fault {
  std::string pointer;  ///< JSON pointer to the place
  std::string detail;   ///< what is wrong, in words
  std::string value;    ///< JSON text of what stands there, bounded in size; empty: nothing to show
  std::string allowed;  ///< what may stand there; empty: not to be said in a line
  /// Of what is wrong within a text: the character, from 0.
  std::optional<std::size_t> position{};
};

/// The faults found so far: one per place, a bounded number in all.
class Faults {
 public:
  static constexpr std::size_t most = 100;
  static constexpr std::size_t suggestions = 10;

  /// Whether no more are taken: reading on would be for nothing.
  bool full() const { return list_.size() >= most; }
  /// Whether one more of them may cost a search for what was meant.
  bool may_suggest() { return suggested_++ < suggestions; }

  void add(Fault fault) {
    if (!full() && !at(fault.pointer)) list_.push_back(std::move(fault));
  }
  bool at(const std::string& pointer) const {
    return std::any_of(list_.begin(), list_.end(), [&](const Fault& f) { return f.pointer == pointer; });
  }
  /// Whether there is a fault at the pointer or below it.
  bool within(const std::string& pointer) const {
    return std::any_of(list_.begin(), list_.end(), [&](const Fault& f) {
      return f.pointer.starts_with(pointer) && (f.pointer.size() == pointer.size() || f.pointer[pointer.size()] == '/');
    });
  }
  bool empty() const { return list_.empty(); }
  const std::vector<Fault>& list() const { return list_; }

 private:
  std::vector<Fault> list_;
  std::size_t suggested_ = 0;
};

}  // namespace least::server
