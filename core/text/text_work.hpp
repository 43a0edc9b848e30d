// The work of writing out texts has one bound for all texts of a request, so that many small ones do not add up.
#pragma once

#include <cstddef>
#include <utility>

#include "core/number/asked_by_thread.hpp"
#include "core/text/text_size.hpp"

namespace least::text {

/// While a TextWork lives, it counts what its thread writes out; of several, the one made last. It also asks now and
/// then whether the computation is still wanted (AskedByThread).
class TextWork {
 public:
  TextWork() : before_(std::exchange(current(), this)) {}
  ~TextWork() { current() = before_; }
  TextWork(const TextWork&) = delete;
  TextWork& operator=(const TextWork&) = delete;

  /// The TextWork of this thread; null where there is none.
  static TextWork* of_thread() { return current(); }

  // Each of these counts some work. False: it is too much, or no longer wanted, and so is all further work.

  /// Characters of texts that are written out.
  bool write(std::size_t characters) { return count(written_, characters, most_written); }
  /// Characters of terms of kept sums, which may be read twice, of indices, and of those that are passed over in search
  /// of a comma or a bracket.
  bool read(std::size_t characters) { return count(read_, characters, 2 * most_of_terms); }
  /// A step of an index whose inner ranges are looked at in a text of so many characters. These may be empty, so that
  /// nothing is written.
  bool step(std::size_t characters) { return read(characters) && count(steps_, 1, most_steps); }

 private:
  static constexpr std::size_t most_steps = 4 * most_terms_of_text, between_questions = 1 << 14;

  static TextWork*& current() {
    thread_local TextWork* work = nullptr;
    return work;
  }
  bool count(std::size_t& all, std::size_t more, std::size_t most) {
    all += more;
    since_ += more;
    if (since_ >= between_questions) {
      since_ = 0;
      wanted_ = wanted_ && AskedByThread::goes_on();
    }
    return wanted_ && all <= most;
  }

  TextWork* before_;
  std::size_t written_ = 0, read_ = 0, steps_ = 0;
  std::size_t since_ = 0;  ///< work since the last question
  bool wanted_ = true;
};

}  // namespace least::text
