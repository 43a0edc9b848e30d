// Formulas as people type them: `-mu/sqrt(x^2 + y^2)`. The operator-precedence parser keeps its own stack, so that no
// input can cause deep recursion; it gives a list of tokens in postfix order, from which symbols on a tape or MathML
// are made.
//   number   3, .5, 1e-3 · name   a letter, then letters, digits, _; or an element of a list: x[3] · pi · ( )
//   + - * /   bind left; unary minus binds tighter than they do · ^ binds right and tighter than that: −x² is −(x²)
//   sin cos tan asin acos atan sinh cosh tanh exp log sqrt abs, and ln for log, ** for ^
// Source: Pratt, Top down operator precedence, POPL 1973; Dijkstra, ALGOL 60 translation, 1961 (shunting yard).
#pragma once

#include <concepts>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <variant>
#include <vector>

#include "core/tape/symbol.hpp"

namespace least::text {

/// Fault says what is wrong with a text, and at which character, counted from 0.
struct Fault {
  std::size_t position = 0;
  std::string detail;
  std::string allowed{};
  std::string unknown{};  ///< the name that is not defined; `allowed` then lists the defined ones
};

/// Limits of a scene that was typed without sums: characters of a text, operations, and depth of brackets.
inline constexpr std::size_t most_characters = 10'000, most_operations = 4'000, most_nesting = 100;
/// Limits of a scene whose sums were written out: characters, and operations; most_kept bounds the operations of all
/// terms of kept sums.
inline constexpr std::size_t most_written = 1'000'000, most_summed = 100'000, most_kept = 2'000'000;

/// function_names() returns the names of the functions that a text may call.
std::span<const std::string_view> function_names();

/// Token is one item of an expression in postfix order.
struct Token {
  enum class Kind : std::uint8_t {
    number,
    name,
    minus,
    add,
    subtract,
    multiply,
    divide,
    power,
    less,
    less_equal,
    greater,
    greater_equal,
    negation,     ///< not
    conjunction,  ///< and
    disjunction,  ///< or
    call,
    kept_sum  ///< a reference to kept sum number `value`, behind the sum's first term
  };
  Kind kind = Kind::number;
  std::uint8_t function = 0;   ///< of a call: index in function_names()
  std::uint8_t arguments = 1;  ///< of a call
  std::uint32_t position = 0;
  double value = 0;
  std::string_view word{};  ///< of a name or a number: the characters typed, a view into the text
};

/// Word is a name that a text may use and the symbol it stands for. A word with a `refusal` may not be used here; the
/// refusal says why.
struct Word {
  std::string_view name;
  Symbol meaning;
  std::string_view refusal{};
};

/// Words are the names that a text may use, found by hashing.
class Words {
 public:
  Words() = default;
  template <class List>
  requires std::convertible_to<List, std::span<const Word>> Words(const List& all) {  // NOLINT: they are nothing else
    for (const Word& word : all) add(word);
  }

  void add(const Word& word) {
    by_name_.try_emplace(word.name, all_.size());
    all_.push_back(word);
  }
  /// find(name) returns the first word of this name; null where there is none.
  const Word* find(std::string_view name) const;
  std::span<const Word> all() const { return all_; }

 private:
  std::vector<Word> all_;
  std::unordered_map<std::string_view, std::size_t> by_name_;  ///< by name, the index of the first word of this name
};

struct KeptSums;

/// Expression is a text that was parsed. It owns the text.
class Expression {
 public:
  /// parse(text) returns the expression, or the first fault. It refuses more than `most` characters, and references to
  /// kept sums from number `sums` on.
  static std::variant<Expression, Fault> parse(std::string text, std::size_t most = most_written, std::size_t sums = 0);

  /// record(tape, words) writes the expression on the tape, with `words` giving the meaning of names. It refuses
  /// constant parts that are not finite, and more than `most` operations. `sums` are the kept sums that the text refers
  /// to; `summed` is increased by the operations of all their terms, which are limited to most_kept.
  std::variant<Symbol, Fault> record(tape::Tape& tape, const Words& words, std::size_t most = most_operations,
                                     const KeptSums* sums = nullptr, std::size_t* summed = nullptr) const;

  /// mathml(shown) returns presentation MathML of the formula as typed, without <math>; `shown` gives the markup of a
  /// name.
  std::string mathml(const std::function<std::string(std::string_view)>& shown) const;

  const std::string& text() const { return *text_; }
  std::span<const Token> tokens() const { return tokens_; }

 private:
  /// On the heap, so that words of tokens stay valid when the Expression moves
  std::shared_ptr<const std::string> text_;
  std::vector<Token> tokens_;  ///< in postfix order
};

/// is_name tells whether a word has the form of a name: a letter, then letters, digits, `_`.
bool is_name(std::string_view word);

/// constant_of(`2*pi/3`) returns the value of a text made of numbers and pi alone; nothing for any other text.
std::optional<double> constant_of(std::string_view text);

}  // namespace least::text
