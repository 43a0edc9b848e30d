#include "core/text/expansion.hpp"

#include <algorithm>
#include <charconv>
#include <iterator>
#include <optional>
#include <tuple>
#include <unordered_map>

#include "core/text/brackets.hpp"
#include "core/text/large_scene_turn.hpp"
#include "core/text/term_reader.hpp"
#include "core/text/text_work.hpp"

namespace least::text {

class Expander {
 public:
  Expander(const Vocabulary& vocabulary, Expansion& made, KeptSums* kept, TextWork& work)
      : vocabulary_(vocabulary), made_(made), kept_(kept), work_(work) {}

  /// fits(…) tells whether the text may become short enough, before any of it is written.
  bool fits(std::string_view text, const Indices& indices) {
    std::size_t place = 0;
    return !exceeds(size_of(text, vocabulary_, indices, kept_ != nullptr, place), kept_ != nullptr) || too_long(place);
  }

  /// write(text, from, to, indices) writes out a part of the current text. False: `wrong_` says what is wrong.
  bool write(std::string_view text, std::size_t from, std::size_t to, Indices& indices) {
    if (++depth_ > most_nesting) return refuse(from, "is nested too deep", std::to_string(most_nesting) + " at most");
    std::size_t at = from;
    while (at < to) {
      if (is_letter(text[at])) {
        if (!word(text, at, to, indices)) return false;
        continue;
      }
      std::size_t end = at;
      while (end < to && !is_letter(text[end]))
        end = is_digit(text[end]) || text[end] == '.' ? end_of_number(text, end, to) : end + 1;
      if (!append(text.substr(at, end - at), at, false)) return false;
      at = end;
    }
    --depth_;
    return true;
  }

  const Expansion::Wrong& wrong() const { return wrong_; }

 private:
  bool refuse(std::size_t position, std::string detail, std::string allowed = {}) {
    return refuse(Fault{position, std::move(detail), std::move(allowed), {}});
  }
  bool refuse(Fault fault) {
    wrong_ = {std::move(fault), Expansion::definition_of(definition_)};
    return false;
  }
  bool too_long(std::size_t position) { return refuse(too_many_operations_at(position)); }
  /// `whole`: the piece is not copied from the current text; all of it comes from `position`.
  bool append(std::string_view piece, std::size_t position, bool whole) {
    if (term_) {
      term_->append(piece);
      return (term_->text().size() <= most_characters && work_.read(piece.size())) || too_long(position);
    }
    if (!work_.write(piece.size())) return too_long(position);
    auto& parts = made_.parts_;
    const std::size_t at = made_.text_.size();
    const bool goes_on = !parts.empty() && !parts.back().whole && !whole && parts.back().definition == definition_ &&
                         parts.back().position + (at - parts.back().at) == position;
    if (!goes_on)
      parts.push_back({static_cast<std::uint32_t>(at), static_cast<std::uint32_t>(position), definition_, whole});
    made_.text_ += piece;
    return true;
  }

  /// WordOfTerms caches a word within the terms of a kept sum: a word that means the same in all terms, or an element
  /// of a list, whose index begins at `index`.
  struct WordOfTerms {
    std::size_t end = 0, index = 0;
    const std::pair<const std::string, std::int64_t>* list = nullptr;
  };

  /// word(…) writes out the word at `at` and moves `at` behind the word and its index or arguments.
  bool word(std::string_view text, std::size_t& at, std::size_t to, Indices& indices) {
    const std::size_t from = at;
    if (term_) {
      if (const auto known = words_of_terms_.find(&text[at]); known != words_of_terms_.end()) {
        const WordOfTerms& word = known->second;
        at = word.end;
        if (word.list) return element(*word.list, text, from, word.index, word.end - 1, indices);
        return append(text.substr(from, at - from), from, false);
      }
    }
    const std::size_t end = end_of_word(text, at, to);
    const std::string_view name = text.substr(from, end - from);
    const std::size_t next = after_space(text, end, to);
    const char sign = next < to ? text[next] : ' ';
    at = end;
    if (sign == '[') {
      at = closing(text, next, to);
      if (at++ == to) return refuse(next, "[ is never closed", "]");
      return element(name, text, from, next + 1, at - 1, indices);
    }
    if (sign == '(' && (name == "sum" || name == "prod" || name == "if")) {
      at = closing(text, next, to);
      if (at++ == to) return refuse(next, "( is never closed", ")");
      if (name == "if") return choice(text, from, next + 1, at - 1, indices);
      return series(text, from, next + 1, at - 1, name == "sum", indices);
    }
    if (const auto value = value_of(name, indices)) return write_number(*value, from);
    if (vocabulary_.fixed.contains(name)) return write_number(vocabulary_.constants.find(name)->second, from);
    const std::size_t number = vocabulary_.definitions.number_of(name);
    if (number >= std::min(known_, vocabulary_.definitions.size())) {
      if (term_ && sign != '(' && !is_common(name)) {
        term_->append_name(name);
        return true;
      }
      if (term_) words_of_terms_[&text[from]] = {at};
      return append(name, from, false);
    }
    Indices arguments;
    const Vocabulary::Defined& defined = vocabulary_.definitions[number];
    if (!defined.indices.empty()) {
      if (sign != '(') return refuse(from, std::string(name) + " is a definition with indices", shape_of(defined));
      at = closing(text, next, to);
      if (at++ == to) return refuse(next, "( is never closed", ")");
      if (!read_arguments(defined, text, from, next + 1, at - 1, indices, arguments)) return false;
    }
    return definition(number, from, arguments);
  }

  bool write_number(std::int64_t value, std::size_t position) {
    if (term_ && term_->append_number(value)) return true;
    const std::string digits = std::to_string(value);
    return append(value < 0 ? "(" + digits + ")" : digits, position, true);
  }
  std::optional<std::int64_t> index(std::string_view text, std::size_t from, std::size_t to, const Indices& indices) {
    if (!work_.read(to - from)) {
      too_long(from);
      return std::nullopt;
    }
    auto read = read_index(text, from, to, vocabulary_, indices, made_.used_);
    if (auto* fault = std::get_if<Fault>(&read)) {
      refuse(std::move(*fault));
      return std::nullopt;
    }
    return std::get<std::int64_t>(read);
  }
  bool element(std::string_view name, std::string_view text, std::size_t position, std::size_t from, std::size_t to,
               const Indices& indices) {
    const auto list = vocabulary_.lists.find(name);
    if (list == vocabulary_.lists.end()) {
      std::string lists;
      for (const auto& [known, count] : vocabulary_.lists) lists += (lists.empty() ? "" : ", ") + known;
      return refuse({position, std::string(name) + " is no list", lists, std::string(name)});
    }
    if (term_) words_of_terms_[&text[position]] = {to + 1, from, &*list};
    return element(*list, text, position, from, to, indices);
  }
  bool element(const std::pair<const std::string, std::int64_t>& list, std::string_view text, std::size_t position,
               std::size_t from, std::size_t to, const Indices& indices) {
    const auto& [name, count] = list;
    const auto at = index(text, from, to, indices);
    if (!at) return false;
    if (*at >= 1 && *at <= count) {
      if (!term_) return append(element_name(name, *at), position, true);
      term_->append_element(name, *at);
      return true;
    }
    std::string where;
    for (const auto& [letter, value] : indices)
      where += (where.empty() ? ", for " : ", ") + letter + " = " + std::to_string(value);
    return refuse(position, element_name(name, *at) + " is beyond the list" + where,
                  element_name(name, 1) + " to " + element_name(name, count));
  }
  bool choice(std::string_view text, std::size_t position, std::size_t from, std::size_t to, Indices& indices) {
    if (!work_.read(2 * (to - from))) return too_long(position);  // they are passed over twice
    const std::size_t first = comma(text, from, to), second = first < to ? comma(text, first + 1, to) : to;
    if (second == to || comma(text, second + 1, to) != to)
      return refuse(position, "if takes a condition and two formulas", "if(i < j, …, …)");
    const std::string_view condition = text.substr(from, first - from);
    // Any other condition depends on the motion and stays in the text
    if (!speaks_of_indices(condition, vocabulary_, indices))
      return append("if(", position, true) && write(text, from, first, indices) && append(",", position, true) &&
             write(text, first + 1, second, indices) && append(",", position, true) &&
             write(text, second + 1, to, indices) && append(")", position, true);
    const auto read = read_condition(text, from, first, vocabulary_, indices, made_.used_);
    if (const auto* fault = std::get_if<Fault>(&read)) return refuse(*fault);
    const bool taken = std::get<bool>(read);
    return append("(", position, true) && write(text, taken ? first + 1 : second + 1, taken ? second : to, indices) &&
           append(")", position, true);
  }
  /// series(…) writes out a sum or a product, from its first range to its closing bracket.
  bool series(std::string_view text, std::size_t position, std::size_t from, std::size_t to, bool adds,
              Indices& indices) {
    bool any = false;
    if (adds && kept_ && !term_)
      if (const auto kept = keep(text, position, from, to, indices)) return *kept;
    if (!append("(", position, true) || !terms(text, position, from, to, adds, indices, any)) return false;
    return any ? append(")", position, true) : append(adds ? "0)" : "1)", position, true);
  }
  /// Range is `i=1..n`; `body` is the position behind its comma.
  struct Range {
    std::string_view letter;
    std::int64_t first, last;
    std::size_t body;
  };
  /// range(…) reads the range at the beginning of a text; nothing where there is none, and then `wrong_` is set.
  std::optional<Range> range(std::string_view text, std::size_t from, std::size_t to, bool adds, Indices& indices) {
    const std::size_t end = comma(text, from, to), equals = text.find('=', from), dots = text.find("..", from);
    const std::size_t name_from = after_space(text, from, end);
    if (end == to || !is_range(text, from, to) || dots >= end || dots < equals) {
      refuse(from, "is no range of an index, followed by what is summed", adds ? "sum(i=1..n, …)" : "prod(i=1..n, …)");
      return std::nullopt;
    }
    const std::string_view letter = text.substr(name_from, end_of_word(text, name_from, end) - name_from);
    if (value_of(letter, indices)) {
      refuse(name_from, std::string(letter) + " is an index already", "a name for each index");
      return std::nullopt;
    }
    const auto first = index(text, equals + 1, dots, indices);
    const auto last = first ? index(text, dots + 2, end, indices) : std::nullopt;
    return last ? std::optional(Range{letter, *first, *last, end + 1}) : std::nullopt;
  }
  bool terms(std::string_view text, std::size_t position, std::size_t from, std::size_t to, bool adds, Indices& indices,
             bool& any) {
    const auto over = range(text, from, to, adds, indices);
    if (!over) return false;
    const bool more = is_range(text, over->body, to);
    indices.emplace_back(over->letter, 0);
    for (std::int64_t i = over->first; i <= over->last; ++i) {
      indices.back().second = i;
      if (++terms_ > most_terms_of_text) return too_long(position);
      if (more) {
        if (!work_.step(to - from)) return too_long(position);
        if (!terms(text, position, over->body, to, adds, indices, any)) return false;
        continue;
      }
      if (any && !append(adds ? "+" : "*", position, true)) return false;
      any = true;
      if (!append("(", position, true) || !write(text, over->body, to, indices) || !append(")", position, true))
        return false;
    }
    indices.pop_back();
    return true;
  }
  /// is_common tells whether a word means the same in all terms.
  static bool is_common(std::string_view name) {
    return name == "pi" || name == "and" || name == "or" || name == "not" ||
           std::ranges::find(function_names(), name) != function_names().end();
  }
  /// each_term calls f(begin, end) with the position of the term for every combination of indices, until f returns
  /// false; nested sums are treated as one sum. False: a range is wrong, or f returned false.
  template <class F>
  bool each_term(std::string_view text, std::size_t from, std::size_t to, Indices& indices, const F& f) {
    const auto over = range(text, from, to, true, indices);
    if (!over) return false;
    const auto [begin, stop] = inner_sum(text, over->body, to);
    const bool more = begin != over->body || is_range(text, begin, stop);
    indices.emplace_back(over->letter, 0);
    bool good = true;
    for (std::int64_t i = over->first; i <= over->last && good; ++i) {
      indices.back().second = i;
      good = more ? work_.step(to - from) && each_term(text, begin, stop, indices, f) : f(begin, stop);
    }
    indices.pop_back();
    return good;
  }
  /// inner_sum returns the contents of a text that is nothing but a sum; else the text itself.
  static std::pair<std::size_t, std::size_t> inner_sum(std::string_view text, std::size_t from, std::size_t to) {
    const std::size_t begin = after_space(text, from, to);
    const std::size_t word = end_of_word(text, begin, to), open = after_space(text, word, to);
    if (text.substr(begin, word - begin) != "sum" || open == to || text[open] != '(') return {from, to};
    const std::size_t close = closing(text, open, to);
    return after_space(text, std::min(close + 1, to), to) == to && close < to ? std::pair(open + 1, close)
                                                                              : std::pair(from, to);
  }
  /// keep(…) makes a kept sum if there are many terms of few shapes. It returns whether that succeeded, or nothing
  /// where the sum is to be written out.
  std::optional<bool> keep(std::string_view text, std::size_t position, std::size_t from, std::size_t to,
                           Indices& indices) {
    std::size_t count = 0;
    each_term(text, from, to, indices, [&](std::size_t, std::size_t) { return ++count <= most_terms_of_text; });
    if (count < kept_->few_terms || count > most_terms_of_text) return std::nullopt;
    if (kept_->terms + count > most_kept) return too_long(position);
    LargeSceneTurn::take();
    constexpr std::size_t bytes_of_term = 32;
    Held held = HeldByThread::take_soon(bytes_of_term * count);
    std::optional<Indices> first;
    std::pair<std::size_t, std::size_t> body;
    const auto read = [&](TermReader& term) {
      const auto before = std::tuple(depth_, definition_, known_, terms_);
      term_ = &term;
      const bool whole = each_term(text, from, to, indices, [&](std::size_t begin, std::size_t end) {
        if (!first) first = indices, body = {begin, end};
        return write(text, begin, end, indices) && term.finish();
      });
      term_ = nullptr;
      std::tie(depth_, definition_, known_, terms_) = before;
      return whole && term.is_worthwhile();
    };
    TermReader differing(*kept_, true), alike(*kept_, false);
    TermReader* const term = read(differing) ? &differing : read(alike) ? &alike : nullptr;
    if (!term) return std::nullopt;  // writing the sum out will find its faults and their positions
    terms_ += count;
    if (terms_ > most_terms_of_text) return too_long(position);
    const std::string number = ")#" + std::to_string(kept_->all.size()) + ")";
    kept_->all.push_back(term->sum());
    held.shrink_to(0);
    kept_->held.add_soon(kept_->all.back().bytes());
    kept_->terms += count;
    KeptSums* const sums = std::exchange(kept_, nullptr);  // within the first term, sums are written out
    const bool good =
        append("((", position, true) && write(text, body.first, body.second, *first) && append(number, position, true);
    kept_ = sums;
    return good;
  }
  static std::string shape_of(const Vocabulary::Defined& defined) {
    std::string shape = defined.name + "(";
    for (const auto& letter : defined.indices) shape += (&letter == &defined.indices.front() ? "" : ", ") + letter;
    return shape + ")";
  }
  bool read_arguments(const Vocabulary::Defined& defined, std::string_view text, std::size_t position, std::size_t from,
                      std::size_t to, const Indices& indices, Indices& arguments) {
    for (const auto& letter : defined.indices) {
      const std::size_t end = comma(text, from, to);
      if ((end == to) != (&letter == &defined.indices.back()))
        return refuse(position, defined.name + " takes " + std::to_string(defined.indices.size()) + " indices",
                      shape_of(defined));
      const auto value = index(text, from, end, indices);
      if (!value) return false;
      arguments.emplace_back(letter, *value);
      from = end + 1;
    }
    return true;
  }
  bool definition(std::size_t which, std::size_t position, Indices& arguments) {
    const auto& defined = vocabulary_.definitions[which];
    if (!append("(", position, true)) return false;
    const auto outer = std::exchange(definition_, static_cast<std::uint32_t>(which));
    const std::size_t known = std::exchange(known_, which);
    if (!write(defined.text, 0, defined.text.size(), arguments)) return false;
    definition_ = outer;
    known_ = known;
    return append(")", position, true);
  }

  const Vocabulary& vocabulary_;
  Expansion& made_;
  KeptSums* kept_;  ///< null: all sums are written out
  TextWork& work_;
  TermReader* term_ = nullptr;  ///< the reader of the kept sum whose term is being written; null outside of kept sums
  /// Cached words, by the address of their first character
  std::unordered_map<const char*, WordOfTerms> words_of_terms_;
  Expansion::Wrong wrong_;
  std::uint32_t definition_ = Expansion::none;  ///< the definition whose text is being written
  std::size_t known_ = std::string::npos;       ///< only definitions with smaller numbers may be used
  std::size_t depth_ = 0;
  std::size_t terms_ = 0;  ///< terms of all sums so far, also those that a condition left empty
};

std::variant<Expansion, Expansion::Wrong> Expansion::of(std::string_view text, const Vocabulary& vocabulary,
                                                        const Indices& indices, KeptSums* kept) {
  Expansion made;
  std::optional<TextWork> alone;
  if (!TextWork::of_thread()) alone.emplace();
  Expander expander(vocabulary, made, kept, *TextWork::of_thread());
  Indices own = indices;
  if (!expander.fits(text, indices) || !expander.write(text, 0, text.size(), own)) return expander.wrong();
  return made;
}

Expansion::Place Expansion::origin(std::size_t position) const {
  if (parts_.empty()) return {position, {}};
  const auto after = std::upper_bound(parts_.begin(), parts_.end(), position,
                                      [](std::size_t at, const Part& part) { return at < part.at; });
  const Part& part = after == parts_.begin() ? *after : *std::prev(after);
  return {part.whole ? part.position : part.position + (position - part.at), definition_of(part.definition)};
}

std::string element_name(std::string_view list, std::int64_t index) {
  return std::string(list).append("[").append(std::to_string(index)).append("]");
}

std::optional<std::pair<std::string_view, std::int64_t>> element_of(std::string_view name) {
  const std::size_t open = name.find('[');
  if (open == std::string_view::npos || name.back() != ']' || !is_name(name.substr(0, open))) return std::nullopt;
  std::int64_t index = 0;
  const char *from = name.data() + open + 1, *to = name.data() + name.size() - 1;
  const auto [end, error] = std::from_chars(from, to, index);
  if (error != std::errc() || end != to || from == to || index < 1 || *from == '0') return std::nullopt;
  return std::pair(name.substr(0, open), index);
}

}  // namespace least::text
