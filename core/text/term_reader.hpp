// Reads the terms of a sum one after the other and finds which of them read alike.
#pragma once

#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/text/expansion.hpp"

namespace least::text {

class TermReader {
 public:
  /// `numbers_differ`: terms may read alike but for what indices are as numbers; a power of such a number would be none
  /// of a constant exponent.
  TermReader(KeptSums& sums, bool numbers_differ) : sums_(sums), numbers_differ_(numbers_differ) {}

  // The term at hand, written piece by piece.
  const std::string& text() const { return text_; }
  void append(std::string_view piece) { text_ += piece; }
  void append_name(std::string_view name) { append_element(name, 0); }
  void append_element(std::string_view list, std::int64_t index) {
    speaks_of_foreign_ = speaks_of_foreign_ || sums_.not_in_them.contains(list);
    append_argument(sums_.names.number_of(list, static_cast<std::size_t>(index)));
  }
  /// What an index is as a number. False: it is written as any number is.
  bool append_number(std::int64_t value);
  /// The term ends. False: there are too many that differ, or one has a power of what differs.
  bool finish();

  /// Whether it speaks of nothing foreign, and many terms read alike.
  bool is_worthwhile() const { return !speaks_of_foreign_ && terms_ >= few_alike * sum_.shapes.size(); }
  KeptSum sum() { return std::move(sum_); }

 private:
  static constexpr std::size_t few_alike = 32, most_shapes = 64;

  void append_argument(std::uint32_t name);

  KeptSums& sums_;
  const bool numbers_differ_;
  KeptSum sum_;
  bool speaks_of_foreign_ = false, has_numbers_ = false;
  std::size_t terms_ = 0;
  std::string text_;
  std::vector<std::uint32_t> given_;  ///< of the term at hand
  std::unordered_map<std::string, std::size_t> shape_of_text_;
};

}  // namespace least::text
