#include "core/text/expansion.hpp"

#include <algorithm>
#include <charconv>
#include <iterator>
#include <optional>

#include "core/text/brackets.hpp"

namespace least::text {

class Expander {
 public:
  Expander(const Vocabulary& vocabulary, Expansion& made) : vocabulary_(vocabulary), made_(made) {}

  /// Writes out a part of the text at hand. False: something is wrong, see `wrong`.
  bool write(std::string_view text, std::size_t from, std::size_t to, Indices& indices) {
    if (++depth_ > most_nesting) return refuse(from, "is nested too deep", std::to_string(most_nesting) + " at most");
    std::size_t at = from;
    while (at < to) {
      const char c = text[at];
      if (is_letter(c)) {
        if (!word(text, at, to, indices)) return false;
        continue;
      }
      const std::size_t end = is_digit(c) || c == '.' ? end_of_number(text, at, to) : at + 1;
      if (!append(text.substr(at, end - at), at, false)) return false;
      at = end;
    }
    --depth_;
    return true;
  }

  const Expansion::Wrong& wrong() const { return wrong_; }

 private:
  static constexpr std::size_t most_terms = 150'000;

  bool refuse(std::size_t position, std::string detail, std::string allowed = {}) {
    return refuse(Fault{position, std::move(detail), std::move(allowed), {}});
  }
  bool refuse(Fault fault) {
    wrong_ = {std::move(fault), definition_};
    return false;
  }
  bool too_long(std::size_t position) {
    return refuse(
        position, "takes too many operations when it is written out",
        std::to_string(most_summed) + " with all sums written out, in " + std::to_string(most_written) + " characters");
  }
  /// `whole`: no character of it stands in the text at hand.
  bool append(std::string_view piece, std::size_t position, bool whole) {
    if (made_.text_.size() + piece.size() > most_written) return too_long(position);
    auto& parts = made_.parts_;
    const std::size_t at = made_.text_.size();
    const bool goes_on = !parts.empty() && !parts.back().whole && !whole && parts.back().definition == definition_ &&
                         parts.back().position + (at - parts.back().at) == position;
    if (!goes_on) parts.push_back({at, position, whole, definition_});
    made_.text_ += piece;
    return true;
  }

  /// A word at `at`, which moves behind it and what belongs to it.
  bool word(std::string_view text, std::size_t& at, std::size_t to, Indices& indices) {
    const std::size_t from = at;
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
    const auto& all = vocabulary_.definitions;
    const auto known = all.begin() + static_cast<std::ptrdiff_t>(std::min(known_, all.size()));
    const auto defined = std::find_if(all.begin(), known, [&](const auto& one) { return one.name == name; });
    if (defined == known) return append(name, from, false);
    Indices arguments;
    if (!defined->indices.empty()) {
      if (sign != '(') return refuse(from, std::string(name) + " is a definition with indices", shape_of(*defined));
      at = closing(text, next, to);
      if (at++ == to) return refuse(next, "( is never closed", ")");
      if (!read_arguments(*defined, text, from, next + 1, at - 1, indices, arguments)) return false;
    }
    return definition(static_cast<std::size_t>(defined - all.begin()), from, arguments);
  }

  bool write_number(std::int64_t value, std::size_t position) {
    const std::string digits = std::to_string(value);
    return append(value < 0 ? "(" + digits + ")" : digits, position, true);
  }
  std::optional<std::int64_t> index(std::string_view text, std::size_t from, std::size_t to, const Indices& indices) {
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
    const auto at = index(text, from, to, indices);
    if (!at) return false;
    if (*at >= 1 && *at <= list->second) return append(element_name(name, *at), position, true);
    std::string where;
    for (const auto& [letter, value] : indices)
      where += (where.empty() ? ", for " : ", ") + letter + " = " + std::to_string(value);
    return refuse(position, element_name(name, *at) + " is beyond the list" + where,
                  element_name(name, 1) + " to " + element_name(name, list->second));
  }
  bool choice(std::string_view text, std::size_t position, std::size_t from, std::size_t to, Indices& indices) {
    const std::size_t first = comma(text, from, to), second = first < to ? comma(text, first + 1, to) : to;
    if (second == to || comma(text, second + 1, to) != to)
      return refuse(position, "if takes a condition and two formulas", "if(i < j, …, …)");
    if (!speaks_of_indices(text, from, first, indices))  // it is settled wherever the motion has come
      return append("if(", position, true) && write(text, from, first, indices) && append(", ", position, true) &&
             write(text, first + 1, second, indices) && append(", ", position, true) &&
             write(text, second + 1, to, indices) && append(")", position, true);
    const auto read = read_condition(text, from, first, vocabulary_, indices, made_.used_);
    if (const auto* fault = std::get_if<Fault>(&read)) return refuse(*fault);
    const bool taken = std::get<bool>(read);
    return append("(", position, true) && write(text, taken ? first + 1 : second + 1, taken ? second : to, indices) &&
           append(")", position, true);
  }
  /// Whether all words of a condition are of indices.
  bool speaks_of_indices(std::string_view text, std::size_t from, std::size_t to, const Indices& indices) const {
    while (from < to) {
      if (!is_letter(text[from])) {
        ++from;
        continue;
      }
      const std::size_t end = end_of_word(text, from, to);
      const std::string_view word = text.substr(from, end - from);
      const bool known = word == "and" || word == "or" || word == "not" || word == "mod" || value_of(word, indices) ||
                         vocabulary_.constants.contains(word);
      if (!known) return false;
      from = end;
    }
    return true;
  }
  /// Of a sum or a product: from the first bound to the last bracket.
  bool series(std::string_view text, std::size_t position, std::size_t from, std::size_t to, bool adds,
              Indices& indices) {
    bool any = false;
    if (!append("(", position, true) || !terms(text, position, from, to, adds, indices, any)) return false;
    return any ? append(")", position, true) : append(adds ? "0)" : "1)", position, true);
  }
  bool terms(std::string_view text, std::size_t position, std::size_t from, std::size_t to, bool adds, Indices& indices,
             bool& any) {
    const std::size_t end = comma(text, from, to), equals = text.find('=', from), dots = text.find("..", from);
    const std::size_t name_from = after_space(text, from, end);
    std::size_t name_to = std::min(equals, end);
    while (name_to > name_from && is_space(text[name_to - 1])) --name_to;
    const bool range = equals < end && dots < end && dots > equals && text[equals + 1] != '=' &&
                       is_name(text.substr(name_from, name_to - name_from));
    if (!range || end == to)
      return refuse(from, "is no range of an index, followed by what is summed",
                    adds ? "sum(i=1..n, …)" : "prod(i=1..n, …)");
    const std::string_view letter = text.substr(name_from, name_to - name_from);
    if (value_of(letter, indices))
      return refuse(name_from, std::string(letter) + " is an index already", "a name for each index");
    const auto first = index(text, equals + 1, dots, indices);
    if (!first) return false;
    const auto last = index(text, dots + 2, end, indices);
    if (!last) return false;
    const bool more = is_range(text, end + 1, to);
    indices.emplace_back(letter, 0);
    for (std::int64_t i = *first; i <= *last; ++i) {
      indices.back().second = i;
      if (++terms_ > most_terms) return too_long(position);
      if (more) {
        if (!terms(text, position, end + 1, to, adds, indices, any)) return false;
        continue;
      }
      if (any && !append(adds ? "+" : "*", position, true)) return false;
      any = true;
      if (!append("(", position, true) || !write(text, end + 1, to, indices) || !append(")", position, true))
        return false;
    }
    indices.pop_back();
    return true;
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
    const auto outer = std::exchange(definition_, which);
    const std::size_t known = std::exchange(known_, which);
    if (!write(defined.text, 0, defined.text.size(), arguments)) return false;
    definition_ = outer;
    known_ = known;
    return append(")", position, true);
  }

  const Vocabulary& vocabulary_;
  Expansion& made_;
  Expansion::Wrong wrong_;
  std::optional<std::size_t> definition_{};  ///< whose text is at hand
  std::size_t known_ = std::string::npos;    ///< so many definitions are
  std::size_t depth_ = 0;
  std::size_t terms_ = 0;  ///< of sums that were looked at, also where a condition left nothing of them
};

std::variant<Expansion, Expansion::Wrong> Expansion::of(std::string_view text, const Vocabulary& vocabulary,
                                                        const Indices& indices) {
  Expansion made;
  Expander expander(vocabulary, made);
  Indices own = indices;
  if (!expander.write(text, 0, text.size(), own)) return expander.wrong();
  return made;
}

Expansion::Place Expansion::origin(std::size_t position) const {
  if (parts_.empty()) return {position, {}};
  const auto after = std::upper_bound(parts_.begin(), parts_.end(), position,
                                      [](std::size_t at, const Part& part) { return at < part.at; });
  const Part& part = after == parts_.begin() ? *after : *std::prev(after);
  return {part.whole ? part.position : part.position + (position - part.at), part.definition};
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
