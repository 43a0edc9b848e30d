#include "core/run/message.hpp"

#include <fmt/format.h>

#include <ostream>

namespace least {

Message Message::time(double t, int digits) {
  Message made;
  made.times_.push_back({0, t, digits});
  return made;
}

Message& Message::add(const Message& after) {
  for (const auto& [place, t, digits] : after.times_) times_.push_back({words_.size() + place, t, digits});
  words_ += after.words_;
  return *this;
}

void Message::turn_times() {
  for (Time& time : times_) time.t = 0 - time.t;  // 0, never −0
}

std::string Message::text() const {
  std::string text;
  std::size_t said = 0;
  for (const auto& [place, t, digits] : times_) {
    text.append(words_, said, place - said);
    said = place;
    text += digits > 0 ? fmt::format("t = {:.{}g}", t, digits) : fmt::format("t = {}", t);
  }
  return text.append(words_, said);
}

std::ostream& operator<<(std::ostream& out, const Message& message) { return out << message.text(); }

}  // namespace least
