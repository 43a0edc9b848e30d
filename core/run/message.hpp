// Text that a run produces, with the times in it kept as numbers: a run backward in time is that of a scene reversed in
// time, and changes the sign of these times before they become text.
#pragma once

#include <iosfwd>
#include <string>
#include <utility>
#include <vector>

namespace least {

class Message {
 public:
  Message() = default;
  Message(std::string words) : words_(std::move(words)) {}  // NOLINT: words are a message
  Message(const char* words) : words_(words) {}             // NOLINT: the same
  /// time(t) is "t = 1.5" with so many digits; 0: the shortest text that reads back as t.
  static Message time(double t, int digits = 0);

  friend Message operator+(Message before, const Message& after) { return std::move(before.add(after)); }

  Message& operator+=(const Message& after) { return add(after); }

  bool empty() const { return words_.empty() && times_.empty(); }
  /// Gives all times the other sign.
  void turn_times();
  std::string text() const;

  friend bool operator==(const Message& a, const Message& b) { return a.text() == b.text(); }
  friend std::ostream& operator<<(std::ostream& out, const Message& message);

 private:
  struct Time {
    std::size_t place;  ///< position in words_ before which the time stands
    double t;
    int digits;
  };

  Message& add(const Message& after);

  std::string words_;
  std::vector<Time> times_;  ///< in order of their places
};

}  // namespace least
