// Text on its way out.
#pragma once

#include <cstddef>
#include <string>

#include "server/shared/answer.hpp"

namespace least::server {

/// Text gathers in it and leaves in pieces, so that little of a large answer exists at a time; where there is nowhere
/// to go, it all stays. After the client has taken no more, what is written is forgotten.
class Outlet {
 public:
  Outlet() = default;
  explicit Outlet(const Write& write) : write_(&write) {}

  std::string& text() { return text_; }

  /// To be called now and then. False: the client takes no more.
  bool pass_on() { return text_.size() < piece || flush(); }
  bool flush() {
    if (write_ == nullptr) return true;
    taken_ = taken_ && (text_.empty() || (*write_)(text_));
    text_.clear();
    return taken_;
  }

 private:
  static constexpr std::size_t piece = 64 * 1024;
  const Write* write_ = nullptr;
  std::string text_;
  bool taken_ = true;
};

}  // namespace least::server
