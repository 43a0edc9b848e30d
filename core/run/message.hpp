// What a run says of itself in words, with the times in it kept as numbers: a run backward in time is one of a scene
// that was turned, and gives them their other sign before all is put into words.
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
  /// "t = 1.5" with so many digits; 0: as many as it takes to read back the same number.
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
    std::size_t place;  ///< in the words, before which it stands
    double t;
    int digits;
  };

  Message& add(const Message& after);

  std::string words_;
  std::vector<Time> times_;  ///< by their places
};

}  // namespace least
