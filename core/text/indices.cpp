#include "core/text/indices.hpp"

#include <algorithm>
#include <charconv>

#include "core/text/characters.hpp"

namespace least::text {
namespace {

constexpr std::int64_t largest_index = 1'000'000'000'000;

/// IndexReader reads a whole number, or a condition on whole numbers, from a part of a text.
class IndexReader {
 public:
  IndexReader(std::string_view text, std::size_t from, std::size_t to, const Vocabulary& vocabulary,
              const Indices& indices, Names& used)
      : text_(text), at_(from), end_(to), vocabulary_(vocabulary), indices_(indices), used_(used) {}

  /// number() reads the whole part as a number, or returns what is wrong with it.
  std::variant<std::int64_t, Fault> number() {
    const auto value = sum();
    if (fault_.detail.empty() && !ended()) refuse("is no part of an index", allowed_number);
    return fault_.detail.empty() ? std::variant<std::int64_t, Fault>(value) : fault_;
  }
  std::variant<bool, Fault> condition() {
    const bool value = any();
    if (fault_.detail.empty() && !ended()) refuse("is no part of a condition on indices", allowed_condition);
    return fault_.detail.empty() ? std::variant<bool, Fault>(value) : fault_;
  }

 private:
  static constexpr const char* allowed_number = "indices, whole constants, + - *, mod(a, n)";
  static constexpr const char* allowed_condition = "comparisons of indices: < <= > >= == !=, and, or, not";

  bool ended() {
    while (at_ < end_ && is_space(text_[at_])) ++at_;
    return at_ == end_;
  }
  bool takes(std::string_view sign) {
    if (ended() || text_[at_] != sign.front()) return false;
    if (text_.substr(at_, std::min(sign.size(), end_ - at_)) != sign) return false;
    if (is_letter(sign.front()) && end_of_word(text_, at_, end_) != at_ + sign.size()) return false;
    at_ += sign.size();
    return true;
  }
  void refuse(std::string detail, std::string allowed) {
    if (fault_.detail.empty()) fault_ = {at_, std::move(detail), std::move(allowed), {}};
  }
  std::int64_t bounded(std::int64_t value) {
    if (value > largest_index || value < -largest_index) refuse("is larger than an index may be", "at most 1e12");
    return fault_.detail.empty() ? value : 0;
  }

  std::int64_t sum() {
    std::int64_t value = product();
    for (;;) {
      if (!fault_.detail.empty()) return 0;
      if (takes("+")) {
        value = bounded(value + product());
      } else if (takes("-")) {
        value = bounded(value - product());
      } else {
        return value;
      }
    }
  }
  std::int64_t product() {
    std::int64_t value = factor();
    while (fault_.detail.empty() && takes("*")) {
      const std::int64_t by = factor();
      if (value != 0 && std::abs(by) > largest_index / std::abs(value)) return bounded(largest_index + 1);
      value *= by;
    }
    return value;
  }
  std::int64_t factor() {
    if (++depth_ > most_nesting) refuse("is nested too deep", std::to_string(most_nesting) + " at most");
    const std::int64_t value = fault_.detail.empty() ? primary() : 0;
    --depth_;
    return value;
  }
  std::int64_t primary() {
    if (ended()) {
      refuse("ends where an index is due", allowed_number);
      return 0;
    }
    if (takes("-")) return -factor();
    if (takes("(")) {
      const std::int64_t value = sum();
      close();
      return value;
    }
    if (takes("mod")) return remainder();
    const char c = text_[at_];
    if (is_digit(c)) {
      std::int64_t value = 0;
      const auto [after, error] = std::from_chars(text_.data() + at_, text_.data() + end_, value);
      if (error != std::errc()) return bounded(largest_index + 1);
      at_ = static_cast<std::size_t>(after - text_.data());
      return bounded(value);
    }
    if (is_letter(c)) return named();
    refuse("is no index", allowed_number);
    return 0;
  }
  std::int64_t remainder() {
    if (!takes("(")) refuse("mod takes two numbers in brackets", "mod(a, n)");
    const std::int64_t a = sum();
    if (!takes(",")) refuse("mod takes two numbers", "mod(a, n)");
    const std::int64_t n = sum();
    if (n <= 0) refuse("mod needs a number above 0", "mod(a, n)");
    close();
    return fault_.detail.empty() ? (a % n + n) % n : 0;
  }
  std::int64_t named() {
    const std::size_t to = end_of_word(text_, at_, end_);
    const std::string_view word = text_.substr(at_, to - at_);
    if (const auto known = value_of(word, indices_)) {
      at_ = to;
      return *known;
    }
    if (const auto constant = vocabulary_.constants.find(word); constant != vocabulary_.constants.end()) {
      used_.emplace(word);
      at_ = to;
      return constant->second;
    }
    refuse(std::string(word) + " is no index and no whole constant", allowed_number);
    return 0;
  }
  void close() {
    if (!takes(")")) refuse("( is never closed", ")");
  }

  bool any() {
    bool value = all();
    while (fault_.detail.empty() && takes("or")) value = all() || value;
    return value;
  }
  bool all() {
    bool value = one();
    while (fault_.detail.empty() && takes("and")) value = one() && value;
    return value;
  }
  bool one() {
    if (++depth_ > most_nesting) refuse("is nested too deep", std::to_string(most_nesting) + " at most");
    const bool value = fault_.detail.empty() && (takes("not") ? !one() : bracketed() ? in_brackets() : comparison());
    --depth_;
    return value;
  }
  /// bracketed() tells whether a bracket opens here that encloses a condition and not a number.
  bool bracketed() {
    if (ended() || text_[at_] != '(') return false;
    std::size_t depth = 0, at = at_;
    for (; at < end_; ++at) {
      if (text_[at] == '(') ++depth;
      if (text_[at] == ')' && --depth == 0) break;
    }
    return text_.substr(at_, at - at_).find_first_of("<>=") != std::string_view::npos;
  }
  bool in_brackets() {
    takes("(");
    const bool value = any();
    close();
    return value;
  }
  bool comparison() {
    const std::int64_t a = sum();
    constexpr std::string_view signs[] = {"<=", ">=", "==", "!=", "<", ">"};
    for (const std::string_view sign : signs) {
      if (!fault_.detail.empty() || !takes(sign)) continue;
      const std::int64_t b = sum();
      return sign == "<="   ? a <= b
             : sign == ">=" ? a >= b
             : sign == "==" ? a == b
             : sign == "!=" ? a != b
             : sign == "<"  ? a < b
                            : a > b;
    }
    refuse("compares nothing", allowed_condition);
    return false;
  }

  std::string_view text_;
  std::size_t at_, end_, depth_ = 0;
  const Vocabulary& vocabulary_;
  const Indices& indices_;
  Names& used_;
  Fault fault_{};
};

}  // namespace

std::optional<std::int64_t> value_of(std::string_view index, const Indices& indices) {
  const auto innermost =
      std::find_if(indices.rbegin(), indices.rend(), [&](const auto& one) { return one.first == index; });
  return innermost == indices.rend() ? std::nullopt : std::optional(innermost->second);
}

std::variant<std::int64_t, Fault> read_index(std::string_view text, std::size_t from, std::size_t to,
                                             const Vocabulary& vocabulary, const Indices& indices, Names& used) {
  // Most indices are a single letter.
  if (const auto value = value_of(text.substr(from, to - from), indices)) return *value;
  return IndexReader(text, from, to, vocabulary, indices, used).number();
}

std::variant<bool, Fault> read_condition(std::string_view text, std::size_t from, std::size_t to,
                                         const Vocabulary& vocabulary, const Indices& indices, Names& used) {
  return IndexReader(text, from, to, vocabulary, indices, used).condition();
}

bool speaks_of_indices(std::string_view condition, const Vocabulary& vocabulary, const Indices& indices) {
  bool whole = condition.find_first_of("./^") == std::string_view::npos, sizes = true, any = false;
  bool of_indices = condition.find("==") != std::string_view::npos || condition.find("!=") != std::string_view::npos;
  if (of_indices) whole = true;  // then read_condition reports anything in it that is no index
  for (std::size_t at = 0; at < condition.size();) {
    if (!is_letter(condition[at])) {
      ++at;
      continue;
    }
    const std::size_t end = end_of_word(condition, at, condition.size());
    const std::string_view word = condition.substr(at, end - at);
    at = end;
    if (word == "and" || word == "or" || word == "not") continue;
    const bool index = word == "mod" || value_of(word, indices);
    if (!index && !vocabulary.constants.contains(word)) return false;
    of_indices = of_indices || index;
    sizes = sizes && (index || vocabulary.fixed.contains(word));
    any = true;
  }
  return whole && (of_indices || (any && sizes));
}

}  // namespace least::text
