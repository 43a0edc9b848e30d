// Formulas as people type them: `-mu/sqrt(x^2 + y^2)`. An operator-precedence parser with a stack of its own, so that
// no input can deepen a recursion; the result is a list in postfix order, which becomes symbols on a tape or MathML.
//   number   3, .5, 1e-3 · name   a letter, then letters, digits, _, or one of many: x[3] · pi · ( )
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

/// What is wrong with a text, and at which of its characters, from 0.
struct Fault {
  std::size_t position = 0;
  std::string detail;
  std::string allowed{};
  std::string unknown{};  ///< the name that nobody knows; `allowed` lists those that are known
};

/// At most so many characters of a text, operations of a scene, and brackets within brackets.
inline constexpr std::size_t most_characters = 10'000, most_operations = 4'000, most_nesting = 100;
/// And of one whose sums were written out: characters, and operations. Of sums that are kept as sums the operations of
/// all terms.
inline constexpr std::size_t most_written = 1'000'000, most_summed = 100'000, most_kept = 2'000'000;

/// The functions that a text can call.
std::span<const std::string_view> function_names();

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
    kept_sum  ///< number `value`, in the place of its first term
  };
  Kind kind = Kind::number;
  std::uint8_t function = 0;   ///< of a call: among function_names()
  std::uint8_t arguments = 1;  ///< of a call
  std::uint32_t position = 0;
  double value = 0;
  std::string_view word{};  ///< of a name or a number, as typed: a part of the text
};

/// A name that a text may use, and what it stands for; where it says why not, it may not be used here.
struct Word {
  std::string_view name;
  Symbol meaning;
  std::string_view refusal{};
};

/// Names that a text may use: of many one is found at once.
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
  /// The first of this name; null where there is none.
  const Word* find(std::string_view name) const;
  std::span<const Word> all() const { return all_; }

 private:
  std::vector<Word> all_;
  std::unordered_map<std::string_view, std::size_t> by_name_;  ///< the place of the first
};

struct KeptSums;

/// A text that was read. It keeps the text.
class Expression {
 public:
  /// At most `most` characters. `sums`: how many kept sums it may speak of.
  static std::variant<Expression, Fault> parse(std::string text, std::size_t most = most_written, std::size_t sums = 0);

  /// Written on the tape, with the names as `words` has them. What is made of constants and is no finite number is
  /// refused, and what takes more than `most` operations of the tape. `sums`: those that it speaks of; `summed`: gets
  /// the operations of their terms, of which there are most_kept at most.
  std::variant<Symbol, Fault> record(tape::Tape& tape, const Words& words, std::size_t most = most_operations,
                                     const KeptSums* sums = nullptr, std::size_t* summed = nullptr) const;

  /// Presentation MathML of the formula as typed, without <math>; a name is shown as `shown` says.
  std::string mathml(const std::function<std::string(std::string_view)>& shown) const;

  const std::string& text() const { return *text_; }
  std::span<const Token> tokens() const { return tokens_; }

 private:
  std::shared_ptr<const std::string> text_;  ///< its address is that of the tokens' words
  std::vector<Token> tokens_;                ///< in postfix order
};

/// Whether a word can be a name: a letter, then letters, digits, `_`.
bool is_name(std::string_view word);

/// The number that a text is which is made of numbers and pi alone, as `2*pi/3`; nothing where it is none.
std::optional<double> constant_of(std::string_view text);

}  // namespace least::text
