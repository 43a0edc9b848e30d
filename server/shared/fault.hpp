// Faults of a request, collected so that a client reads all of them at once.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace least::server {

/// Fault is one thing that is wrong with a request.
struct Fault {
  std::string pointer;  ///< JSON pointer to the place
  std::string detail;   ///< what is wrong, in words
  std::string value;    ///< JSON text of the value there, limited in size; empty: nothing to show
  std::string allowed;  ///< what is allowed there; empty where that takes more than a line
  /// For a fault within a text, the index of the character, from 0.
  std::optional<std::size_t> position{};
};

/// Faults are the faults found so far: one per place, and a limited number.
class Faults {
 public:
  static constexpr std::size_t most = 100;
  static constexpr std::size_t suggestions = 10;

  /// full() tells that no more are stored, so that reading on is useless.
  bool full() const { return list_.size() >= most; }
  /// may_suggest() tells, for the first few calls, that a fault may search for a similar name.
  bool may_suggest() { return suggested_++ < suggestions; }

  void add(Fault fault) {
    if (!full() && !at(fault.pointer)) list_.push_back(std::move(fault));
  }
  bool at(const std::string& pointer) const {
    return std::any_of(list_.begin(), list_.end(), [&](const Fault& f) { return f.pointer == pointer; });
  }
  /// within tells whether there is a fault at the pointer or below it.
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
