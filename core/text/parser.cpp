#include "core/text/parser.hpp"

#include <charconv>
#include <string>
#include <utility>

#include "core/text/characters.hpp"
#include "core/text/functions.hpp"

namespace least::text {
namespace {

using TokenKind = Token::Kind;

std::string listed_functions() {
  std::string all;
  for (const auto function : functions) all += (all.empty() ? "" : ", ") + std::string(function);
  return all;
}

class Parser {
 public:
  Parser(std::string_view text, std::size_t most, std::size_t sums) : text_(text), most_(most), sums_(sums) {}

  std::optional<Fault> read(std::vector<Token>& postfix) {
    if (text_.size() > most_)
      return Fault{most_, "is longer than a scene may be", std::to_string(most_) + " characters"};
    while (skip_space(), at_ < text_.size())
      if (auto fault = expects_operand_ ? operand(postfix) : operation(postfix)) return fault;
    if (expects_operand_)
      return Fault{text_.size(),
                   postfix.empty() && stack_.empty() ? "is empty" : "ends where a number, a name or ( is due"};
    while (!stack_.empty()) {
      if (stack_.back().bracket) return Fault{stack_.back().token.position, "( is never closed", ")"};
      postfix.push_back(stack_.back().token);
      stack_.pop_back();
    }
    return std::nullopt;
  }

 private:
  struct Pending {
    Token token;
    bool bracket = false;
    std::size_t arguments = 1;  ///< of a bracket: how many arguments it has so far
  };

  /// Bound of the stack: each bracket may hold itself, a function and operations before it.
  static constexpr std::size_t deepest = 5 * most_nesting;

  void skip_space() {
    while (at_ < text_.size() && is_space(text_[at_])) ++at_;
  }
  std::uint32_t here() const { return static_cast<std::uint32_t>(at_); }
  Fault stranger() const {
    const char c = text_[at_];
    if (static_cast<unsigned char>(c) >= 0x80)
      return {at_, "is no ASCII character", "letters a–z, digits, + - * / ^ ( )"};
    return {at_, std::string("'") + c + "' means nothing here", "letters a–z, digits, + - * / ^ ( )"};
  }

  std::optional<Fault> operand(std::vector<Token>& postfix) {
    const char c = text_[at_];
    if (c == '(') return open();
    if (c == '-' || c == '+') {
      if (c == '-' && stack_.size() > deepest) return too_deep();
      if (c == '-') stack_.push_back({{.kind = TokenKind::minus, .position = here()}});
      ++at_;
      return std::nullopt;
    }
    if (is_digit(c) || c == '.') return number(postfix);
    if (is_letter(c)) return name(postfix);
    if (std::string_view(")*/^,<>").find(c) != std::string_view::npos)
      return Fault{at_, "a number, a name or ( is due here"};
    return stranger();
  }

  /// Signs and powers that wait for their operand count as nesting, as brackets do.
  Fault too_deep() const { return {at_, "is nested too deep", std::to_string(most_nesting) + " at most"}; }

  std::optional<Fault> open() {
    if (++nesting_ > most_nesting) return too_deep();
    stack_.push_back({{.position = here()}, true});
    ++at_;
    return std::nullopt;
  }

  std::optional<Fault> number(std::vector<Token>& postfix) {
    double value = 0;
    const char* from = text_.data() + at_;
    const auto [end, error] = std::from_chars(from, text_.data() + text_.size(), value);
    if (error == std::errc::invalid_argument) return Fault{at_, "is no number"};
    if (error == std::errc::result_out_of_range) return Fault{at_, "is a number that no double holds"};
    const auto length = static_cast<std::size_t>(end - from);
    postfix.push_back({.position = here(), .value = value, .word = text_.substr(at_, length)});
    at_ += length;
    expects_operand_ = false;
    return std::nullopt;
  }

  std::optional<Fault> name(std::vector<Token>& postfix) {
    const std::size_t from = at_;
    at_ = end_of_word(text_, at_, text_.size());
    skip_index();
    const std::string_view word = text_.substr(from, at_ - from);
    if (word == "not") {
      if (stack_.size() > deepest) return too_deep();
      stack_.push_back({{.kind = TokenKind::negation, .position = static_cast<std::uint32_t>(from), .word = word}});
      return std::nullopt;
    }
    const auto found = std::find(functions.begin(), functions.end(), word);
    if (found == functions.end()) {
      skip_space();
      const bool called = at_ < text_.size() && text_[at_] == '(';
      if (called && word == "mod")  // it is known, but not here
        return Fault{from, "mod is of whole numbers alone: of indices in brackets, in bounds and in conditions",
                     "as q[mod(i, n) + 1]"};
      if (called)
        return Fault{from, std::string(word) + " is no function, and a product needs its sign", listed_functions(),
                     std::string(word)};
      postfix.push_back({.kind = TokenKind::name, .position = static_cast<std::uint32_t>(from), .word = word});
      expects_operand_ = false;
      return std::nullopt;
    }
    skip_space();
    if (at_ == text_.size() || text_[at_] != '(')
      return Fault{from, std::string(word) + " is a function: its argument stands in brackets",
                   std::string(word) + "(…)"};
    stack_.push_back({{.kind = TokenKind::call,
                       .function = static_cast<std::uint8_t>(found - functions.begin()),
                       .position = static_cast<std::uint32_t>(from),
                       .word = word}});
    return open();
  }

  /// skip_index() moves past an index such as `[3]`, if one stands here.
  void skip_index() {
    std::size_t to = at_;
    if (to == text_.size() || text_[to++] != '[') return;
    const std::size_t digits = to;
    while (to < text_.size() && is_digit(text_[to])) ++to;
    if (to > digits && to < text_.size() && text_[to] == ']') at_ = to + 1;
  }

  /// sign() returns the operation that stands here and its number of characters; 0 characters where there is none.
  std::pair<TokenKind, std::size_t> sign() const {
    struct Sign {
      std::string_view text;
      TokenKind kind;
    };
    constexpr Sign all[] = {
        {"**", TokenKind::power},  {"<=", TokenKind::less_equal},   {">=", TokenKind::greater_equal},
        {"+", TokenKind::add},     {"-", TokenKind::subtract},      {"*", TokenKind::multiply},
        {"/", TokenKind::divide},  {"^", TokenKind::power},         {"<", TokenKind::less},
        {">", TokenKind::greater}, {"and", TokenKind::conjunction}, {"or", TokenKind::disjunction}};
    for (const Sign& sign : all) {
      if (!text_.substr(at_).starts_with(sign.text)) continue;
      if (is_letter(sign.text.front()) && end_of_word(text_, at_, text_.size()) != at_ + sign.text.size()) continue;
      return {sign.kind, sign.text.size()};
    }
    return {TokenKind::number, 0};
  }

  std::optional<Fault> operation(std::vector<Token>& postfix) {
    const char c = text_[at_];
    if (c == ')') return close(postfix);
    if (c == ',') return next_argument(postfix);
    if (c == '#' && sums_ > 0) return kept_sum(postfix);
    const auto [kind, length] = sign();
    if (length == 0 && (c == '(' || c == '.' || is_digit(c) || is_letter(c)))
      return Fault{at_, "a product needs its sign", "* before this"};
    if (length == 0) return stranger();
    const Precedence mine = precedence(kind);
    while (!stack_.empty() && !stack_.back().bracket) {
      const Precedence top = precedence(stack_.back().token.kind);
      if (!(top.binds > mine.binds || (top.binds == mine.binds && !mine.right))) break;
      postfix.push_back(stack_.back().token);
      stack_.pop_back();
    }
    if (stack_.size() > deepest) return too_deep();
    stack_.push_back({{.kind = kind, .position = here()}});
    at_ += length;
    expects_operand_ = true;
    return std::nullopt;
  }

  /// kept_sum reads `#number` behind the first term of a kept sum.
  std::optional<Fault> kept_sum(std::vector<Token>& postfix) {
    std::size_t number = 0;
    const char* from = text_.data() + at_ + 1;
    const auto [end, error] = std::from_chars(from, text_.data() + text_.size(), number);
    if (error != std::errc() || number >= sums_) return stranger();
    postfix.push_back({.kind = TokenKind::kept_sum, .position = here(), .value = static_cast<double>(number)});
    at_ += static_cast<std::size_t>(end - from) + 1;
    return std::nullopt;
  }

  /// settle moves all operations above the last bracket to the output.
  void settle(std::vector<Token>& postfix) {
    while (!stack_.empty() && !stack_.back().bracket) {
      postfix.push_back(stack_.back().token);
      stack_.pop_back();
    }
  }
  /// calls() tells whether the topmost bracket is that of a function.
  bool calls() const {
    return stack_.size() > 1 && stack_[stack_.size() - 2].token.kind == TokenKind::call &&
           !stack_[stack_.size() - 2].bracket;
  }

  std::optional<Fault> next_argument(std::vector<Token>& postfix) {
    settle(postfix);
    if (stack_.empty() || !calls()) return Fault{at_, "a comma stands between the arguments of a function alone"};
    ++stack_.back().arguments;
    ++at_;
    expects_operand_ = true;
    return std::nullopt;
  }

  std::optional<Fault> close(std::vector<Token>& postfix) {
    settle(postfix);
    if (stack_.empty()) return Fault{at_, ") was never opened"};
    const bool of_call = calls();
    const std::size_t arguments = stack_.back().arguments;
    stack_.pop_back();
    --nesting_;
    if (of_call) {
      Token& token = stack_.back().token;
      const Arity takes = arity(token.function);
      if (arguments < takes.least || arguments > takes.most) {
        const std::string most = takes.most > takes.least ? " to " + std::to_string(takes.most) : "";
        return Fault{token.position, std::string(token.word) + " is given " + std::to_string(arguments) + " arguments",
                     std::to_string(takes.least) + most};
      }
      token.arguments = static_cast<std::uint8_t>(arguments);
      postfix.push_back(token);
      stack_.pop_back();
    }
    ++at_;
    return std::nullopt;
  }

  std::string_view text_;
  std::size_t most_, sums_, at_ = 0, nesting_ = 0;
  bool expects_operand_ = true;
  std::vector<Pending> stack_;
};

}  // namespace

std::optional<Fault> read_postfix(std::string_view text, std::size_t most, std::size_t sums,
                                  std::vector<Token>& postfix) {
  return Parser(text, most, sums).read(postfix);
}

}  // namespace least::text
