// Reads the terms of a sum one after the other and finds which of them read alike.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/text/expansion.hpp"

namespace least::text {

class TermReader {
 public:
  /// `foreign`: names that no term may speak of.
  explicit TermReader(const Names& foreign) : foreign_(foreign) {}

  // The term at hand, written piece by piece.
  const std::string& text() const { return text_; }
  void append(std::string_view piece) { text_ += piece; }
  void append_name(std::string_view name) { append_argument(number_of(name, 0)); }
  void append_element(std::string_view list, std::int64_t index) {
    append_argument(number_of(list, static_cast<std::size_t>(index)));
  }
  /// The term ends. False: there are too many that differ.
  bool finish();

  /// Whether it speaks of nothing foreign, and many terms read alike.
  bool is_worthwhile() const { return !speaks_of_foreign_ && terms_ >= few_alike * sum_.shapes.size(); }
  KeptSum sum() { return std::move(sum_); }

 private:
  static constexpr std::size_t few_alike = 32, most_shapes = 64;

  std::uint32_t number_of(std::string_view list, std::size_t index);
  void append_argument(std::uint32_t name);

  const Names& foreign_;
  KeptSum sum_;
  bool speaks_of_foreign_ = false;
  std::size_t terms_ = 0;
  std::string text_;
  std::vector<std::uint32_t> given_;  ///< of the term at hand
  std::unordered_map<std::string, std::size_t> shape_of_text_;
  std::map<std::string, std::vector<std::uint32_t>, std::less<>> numbers_;  ///< of names: one more; 0 where unknown
};

}  // namespace least::text
