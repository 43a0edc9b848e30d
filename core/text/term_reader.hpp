// Reads the terms of a sum one after the other and finds those that differ only in the names they contain.
#pragma once

#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/text/expansion.hpp"

namespace least::text {

/// TermReader builds one KeptSum.
class TermReader {
 public:
  /// `numbers_differ`: the values of indices become placeholders, too, so that terms may differ in them. Such a value
  /// must not be in an exponent, which would no longer be constant.
  TermReader(KeptSums& sums, bool numbers_differ) : sums_(sums), numbers_differ_(numbers_differ) {}

  // The current term, written piece by piece.
  const std::string& text() const { return text_; }
  void append(std::string_view piece) { text_ += piece; }
  void append_name(std::string_view name) { append_element(name, 0); }
  void append_element(std::string_view list, std::int64_t index) {
    speaks_of_foreign_ = speaks_of_foreign_ || sums_.not_in_them.contains(list);
    append_argument(sums_.names.number_of(list, static_cast<std::size_t>(index)));
  }
  /// append_number writes the value of an index as a placeholder. False: the caller has to write it as digits.
  bool append_number(std::int64_t value);
  /// finish() ends the current term. False: there are too many shapes, or a placeholder may be in an exponent.
  bool finish();

  /// is_worthwhile tells whether the sum names nothing that kept sums may not name, and has many terms per shape.
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
  std::vector<std::uint32_t> given_;  ///< the names of the current term, by number
  std::unordered_map<std::string, std::size_t> shape_of_text_;
};

}  // namespace least::text
