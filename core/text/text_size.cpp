#include "core/text/text_size.hpp"

#include <algorithm>
#include <optional>
#include <vector>

#include "core/text/brackets.hpp"
#include "core/text/characters.hpp"

namespace least::text {
namespace {

/// Sizes end here, far beyond all limits, so that no sum or product of two of them overflows.
constexpr std::size_t beyond_all = std::size_t{1} << 31;

constexpr std::size_t times(std::size_t a, std::size_t b) { return std::min(a * b, beyond_all); }

TextSize of_characters(std::size_t count) { return {count, count, 0, 0}; }

class SizeReader {
 public:
  SizeReader(std::string_view text, const Vocabulary& vocabulary, const Indices& indices)
      : text_(text), vocabulary_(vocabulary), indices_(indices) {}

  /// part(…) returns the size of a part of the text. see(position, size so far) is called after each word.
  template <class See>
  TextSize part(std::size_t from, std::size_t to, const See& see) {
    TextSize size;
    if (++depth_ > most_nesting) return size;  // writing it out will refuse it
    for (std::size_t at = from; at < to;) {
      std::size_t end = at;
      if (is_letter(text_[at])) {
        add(size, word(at, to, end));
        see(at, size);
      } else {
        while (end < to && !is_letter(text_[end]))
          end = is_digit(text_[end]) || text_[end] == '.' ? end_of_number(text_, end, to) : end + 1;
        add(size, of_characters(end - at));
      }
      at = end;
    }
    --depth_;
    return size;
  }

 private:
  static constexpr std::size_t few_terms = 64;  ///< sums of fewer terms are never kept
  static constexpr std::size_t most_steps = 4096;

  struct Range {
    std::string_view letter, first, last;
  };

  TextSize part(std::size_t from, std::size_t to) {
    return part(from, to, [](std::size_t, const TextSize&) {});
  }

  /// word(at, …) returns the size of the word at `at`, with its index or arguments, and sets `end` behind them.
  TextSize word(std::size_t at, std::size_t to, std::size_t& end) {
    end = end_of_word(text_, at, to);
    const std::string_view name = text_.substr(at, end - at);
    const std::size_t next = after_space(text_, end, to);
    const char sign = next < to ? text_[next] : ' ';
    if (sign == '[') {
      constexpr std::size_t shortest_index = 3;  // [1]
      end = std::min(closing(text_, next, to) + 1, to);
      return of_characters(name.size() + shortest_index);
    }
    if (sign == '(' && (name == "sum" || name == "prod" || name == "if")) {
      const std::size_t close = closing(text_, next, to);
      end = std::min(close + 1, to);
      return name == "if" ? choice(next + 1, close) : series(next + 1, close, name == "sum");
    }
    if (value_of(name, indices_) || std::ranges::find(letters_, name) != letters_.end()) return of_characters(1);
    if (vocabulary_.constants.contains(name)) return of_characters(1);
    const std::size_t number = vocabulary_.definitions.number_of(name);
    if (number == vocabulary_.definitions.size()) return of_characters(name.size());
    const Vocabulary::Defined& defined = vocabulary_.definitions[number];
    if (!defined.indices.empty() && sign == '(') end = std::min(closing(text_, next, to) + 1, to);
    TextSize size = defined.size;
    add(size, of_characters(2));
    return size;
  }

  TextSize choice(std::size_t from, std::size_t to) {
    const std::size_t first = comma(text_, from, to), second = first < to ? comma(text_, first + 1, to) : to;
    if (second == to) return {};
    const TextSize a = part(first + 1, second), b = part(second + 1, to);
    return {std::min(a.characters, b.characters), std::min(a.with_kept_sums, b.with_kept_sums),
            std::min(a.terms, b.terms), std::min(a.kept, b.kept)};
  }

  /// series(…) returns the size of a sum or a product, from its first range to its closing bracket.
  TextSize series(std::size_t from, std::size_t to, bool adds) {
    std::vector<Range> ranges;
    while (is_range(text_, from, to)) {
      const std::size_t end = comma(text_, from, to), equals = text_.find('=', from), dots = text_.find("..", from);
      if (dots >= end || dots < equals) return {};
      const std::size_t name = after_space(text_, from, end);
      ranges.push_back({text_.substr(name, end_of_word(text_, name, end) - name),
                        text_.substr(equals + 1, dots - equals - 1), text_.substr(dots + 2, end - dots - 2)});
      from = end + 1;
    }
    if (ranges.empty()) return {};
    std::size_t steps = most_steps, outer = 0;
    const std::size_t count = terms(ranges, 0, steps, outer);
    for (const Range& range : ranges) letters_.push_back(range.letter);
    const TextSize body = part(from, to);
    letters_.resize(letters_.size() - ranges.size());
    constexpr std::size_t signs = 3;  // two brackets, and the sign between terms
    TextSize size{times(count, body.characters + signs), times(count, body.with_kept_sums + signs),
                  std::max(outer, times(count, std::max<std::size_t>(body.terms, 1))), times(count, body.kept)};
    if (adds && size.terms >= few_terms) {
      // A kept term takes its addition, and at least one operation more unless it is a single name or number.
      size.kept = std::max(size.kept, times(count, combines(from, to) ? 2 : 1));
      size.with_kept_sums = 0;
    }
    return size;
  }

  /// combines tells whether a term of elements of lists combines them by an operation or a function. Of conditions it
  /// is not known what stays.
  bool combines(std::size_t from, std::size_t to) const {
    const std::string_view term = text_.substr(from, to - from);
    if (term.find('[') == term.npos || speaks_of(term, "if")) return false;
    for (std::size_t at = from; at < to; ++at) {
      if (std::string_view("+*/^").find(text_[at]) != std::string_view::npos) return true;
      if (text_[at] == '-' && after_space(text_, from, to) < at) return true;
      if (text_[at] == '[') at = std::min(closing(text_, at, to), to);
    }
    return false;
  }

  /// terms returns how many combinations of indices there are from the range with this number on; `steps` bounds the
  /// steps of indices on which inner ranges depend. `outer` receives the steps of the first range.
  std::size_t terms(const std::vector<Range>& ranges, std::size_t which, std::size_t& steps, std::size_t& outer) {
    const Range& range = ranges[which];
    const auto first = bound(range.first), last = bound(range.last);
    if (!first || !last || *last < *first) return 0;
    const std::size_t count =
        static_cast<std::size_t>(std::min(*last - *first + 1, static_cast<std::int64_t>(beyond_all)));
    if (which == 0) outer = count;
    if (which + 1 == ranges.size()) return count;
    const bool needed =
        std::any_of(ranges.begin() + static_cast<std::ptrdiff_t>(which) + 1, ranges.end(),
                    [&](auto& one) { return speaks_of(one.first, range.letter) || speaks_of(one.last, range.letter); });
    std::size_t all = 0;
    if (needed && count > steps) return 0;
    if (needed) steps -= count;
    indices_.emplace_back(range.letter, *first);
    if (!needed) {
      all = times(count, terms(ranges, which + 1, steps, outer));
    } else {
      for (std::int64_t i = *first; i <= *last; ++i) {
        indices_.back().second = i;
        all = std::min(all + terms(ranges, which + 1, steps, outer), beyond_all);
      }
    }
    indices_.pop_back();
    return all;
  }

  /// bound returns the value of a bound of a range; nothing where it depends on an index whose value is not known.
  std::optional<std::int64_t> bound(std::string_view typed) const {
    if (std::ranges::any_of(letters_, [&](std::string_view letter) { return speaks_of(typed, letter); }))
      return std::nullopt;
    Names used;
    const auto value = read_index(typed, 0, typed.size(), vocabulary_, indices_, used);
    return std::holds_alternative<Fault>(value) ? std::nullopt : std::optional(std::get<std::int64_t>(value));
  }

  std::string_view text_;
  const Vocabulary& vocabulary_;
  Indices indices_;
  std::vector<std::string_view> letters_;  ///< indices of enclosing sums, whose values are not known
  std::size_t depth_ = 0;
};

}  // namespace

void add(TextSize& all, const TextSize& part) {
  all.characters = std::min(all.characters + part.characters, beyond_all);
  all.with_kept_sums = std::min(all.with_kept_sums + part.with_kept_sums, beyond_all);
  all.terms = std::min(all.terms + part.terms, beyond_all);
  all.kept = std::min(all.kept + part.kept, beyond_all);
}

Fault too_many_operations_at(std::size_t position) {
  return {position,
          "takes too many operations when it is written out",
          std::to_string(most_summed) + " with all sums written out, in " + std::to_string(most_written) +
              " characters of all texts together",
          {}};
}

TextSize size_of(std::string_view text, const Vocabulary& vocabulary, const Indices& indices, bool keeps,
                 std::size_t& place) {
  bool found = false;
  return SizeReader(text, vocabulary, indices).part(0, text.size(), [&](std::size_t at, const TextSize& size) {
    if (!found && exceeds(size, keeps)) found = true, place = at;
  });
}

}  // namespace least::text
