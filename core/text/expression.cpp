#include "core/text/expression.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "core/text/characters.hpp"
#include "core/text/functions.hpp"
#include "core/text/kept_sum.hpp"
#include "core/text/parser.hpp"

namespace least::text {
namespace {

using TokenKind = Token::Kind;

/// Value is what a part of a text evaluates to: a number; or a condition, which holds where `number` is negative, or,
/// if `negated`, where it is not.
struct Value {
  Symbol number;
  bool condition = false, negated = false;

  Symbol::Mask mask() const { return {number, negated}; }
};

Value holds(const Symbol::Mask& mask) { return {mask.difference, true, mask.negated}; }
/// settled(number) returns the condition that a number −1 (true) or 1 (false) stands for.
Value settled(const Symbol& number) { return {number, true, false}; }

/// angle(y, x) is atan2: from y/x where |y| < |x|, else from x/y.
Symbol angle(const Symbol& y, const Symbol& x) {
  const Symbol half = std::numbers::pi / 2, whole = std::numbers::pi;
  const auto flat = abs(y) < abs(x);
  const Symbol slope = atan(y / select(flat, x, Symbol(1))), other = atan(x / select(flat, Symbol(1), y));
  const Symbol behind = slope + select(y < Symbol(0), -whole, whole);
  return select(flat, select(x < Symbol(0), behind, slope), select(y < Symbol(0), -half, half) - other);
}

Symbol call(const Token& token, std::span<const Value> arguments) {
  using Function = Symbol (*)(const Symbol&);
  constexpr Function by_name[] = {
      [](const Symbol& a) { return sin(a); },
      [](const Symbol& a) { return cos(a); },
      [](const Symbol& a) { return tan(a); },
      [](const Symbol& a) { return asin(a); },
      [](const Symbol& a) { return acos(a); },
      [](const Symbol& a) { return atan(a); },
      [](const Symbol& a) { return sinh(a); },
      [](const Symbol& a) { return cosh(a); },
      [](const Symbol& a) { return tanh(a); },
      [](const Symbol& a) { return exp(a); },
      [](const Symbol& a) { return log(a); },
      [](const Symbol& a) { return sqrt(a); },
      [](const Symbol& a) { return abs(a); },
      [](const Symbol& a) { return log(a); },
      [](const Symbol& a) { return select(a < Symbol(0), Symbol(-1), select(Symbol(0) < a, Symbol(1), Symbol(0))); },
  };
  if (token.function < std::size(by_name)) return by_name[token.function](arguments[0].number);
  Symbol made = arguments[0].number;
  if (token.word == "if") return select(arguments[0].mask(), arguments[1].number, arguments[2].number);
  if (token.word == "hypot") return sqrt(made * made + arguments[1].number * arguments[1].number);
  if (token.word == "atan2") return angle(made, arguments[1].number);
  for (const Value& other : arguments.subspan(1)) {
    const auto less = other.number < made;
    made = token.word == "min" ? select(less, other.number, made) : select(less, made, other.number);
  }
  return made;
}

/// compare combines two numbers by a comparison, or two conditions by and/or, to a condition.
Value compare(TokenKind kind, const Value& a, const Value& b) {
  switch (kind) {
    case TokenKind::less:
      return holds(a.number < b.number);
    case TokenKind::less_equal:
      return holds(a.number <= b.number);
    case TokenKind::greater:
      return holds(a.number > b.number);
    case TokenKind::greater_equal:
      return holds(a.number >= b.number);
    case TokenKind::conjunction:
      return settled(select(a.mask(), select(b.mask(), Symbol(-1), Symbol(1)), Symbol(1)));
    default:
      return settled(select(a.mask(), Symbol(-1), select(b.mask(), Symbol(-1), Symbol(1))));
  }
}

Symbol operate(TokenKind kind, const Symbol& a, const Symbol& b) {
  switch (kind) {
    case TokenKind::add:
      return a + b;
    case TokenKind::subtract:
      return a - b;
    case TokenKind::multiply:
      for (const auto& [zero, other] : {std::pair{&a, &b}, std::pair{&b, &a}})
        if (zero->is_constant() && zero->constant() == 0 && Recorder::node(*other).partial)
          return Recorder::binary(tape::Op::multiply, *zero, *other);  // 0·log(−1) must stay NaN
      return a * b;
    case TokenKind::divide:
      return a / b;
    default:
      return raise(a, b);
  }
}

std::string listed(std::span<const Word> words) {
  std::string names;
  for (const Word& word : words)
    if (word.refusal.empty()) names.append(names.empty() ? "" : ", ").append(word.name);
  return names + (names.empty() ? "pi" : ", pi");
}

// is_finite tells whether all constants written from place `from` on are finite, as x/0 is recorded as x·(1/0).
bool is_finite(const Symbol& made, const tape::Tape& tape, tape::Index from) {
  for (; from < tape.size(); ++from)
    if (tape[from].op == tape::Op::constant && !std::isfinite(tape[from].value)) return false;
  return !made.is_constant() || std::isfinite(made.constant());
}

}  // namespace

std::span<const std::string_view> function_names() { return functions; }

bool is_name(std::string_view word) {
  return !word.empty() && is_letter(word.front()) && std::all_of(word.begin(), word.end(), is_part);
}

const Word* Words::find(std::string_view name) const {
  const auto found = by_name_.find(name);
  return found != by_name_.end() ? &all_[found->second] : nullptr;
}

std::variant<Expression, Fault> Expression::parse(std::string text, std::size_t most, std::size_t sums) {
  Expression read;
  read.text_ = std::make_shared<const std::string>(std::move(text));
  if (auto fault = read_postfix(*read.text_, most, sums, read.tokens_)) return std::move(*fault);
  return read;
}

std::optional<double> constant_of(std::string_view text) {
  const auto parsed = Expression::parse(std::string(text), most_characters);
  const auto* expression = std::get_if<Expression>(&parsed);
  if (!expression) return std::nullopt;
  tape::Tape tape;
  const auto recorded = expression->record(tape, {});
  const auto* symbol = std::get_if<Symbol>(&recorded);
  return symbol && symbol->is_constant() ? std::optional(symbol->constant()) : std::nullopt;
}

namespace {

/// parts_of returns how many operands a token takes; below, whether the operand at `i` has to be a condition.
std::size_t parts_of(const Token& token) {
  if (token.kind == TokenKind::number || token.kind == TokenKind::name) return 0;
  if (token.kind == TokenKind::call) return token.arguments;
  const bool of_one =
      token.kind == TokenKind::minus || token.kind == TokenKind::negation || token.kind == TokenKind::kept_sum;
  return of_one ? 1 : 2;
}
bool takes_condition(const Token& token, std::size_t i) {
  return (token.kind >= TokenKind::negation && token.kind <= TokenKind::disjunction) ||
         (token.kind == TokenKind::call && token.word == "if" && i == 0);
}

}  // namespace

std::variant<Symbol, Fault> Expression::record(tape::Tape& tape, const Words& words, std::size_t most,
                                               const KeptSums* sums, std::size_t* summed) const {
  std::vector<Value> stack;
  for (const Token& token : tokens_) {
    const tape::Index from = tape.size();
    const std::size_t count = parts_of(token);
    const std::span<const Value> parts = std::span(stack).last(count);
    for (std::size_t i = 0; i < count; ++i)
      if (parts[i].condition != takes_condition(token, i))
        return parts[i].condition ? Fault{token.position, "is given a condition where a number is due"}
                                  : Fault{token.position, "is given a number where a condition is due", "a < b"};
    Value made;
    if (token.kind == TokenKind::number) {
      made.number = token.value;
    } else if (token.kind == TokenKind::name) {
      const Word* const known = words.find(token.word);
      if (known && known->refusal.empty()) {
        made.number = known->meaning;
      } else if (!known && token.word == "pi") {
        made.number = std::numbers::pi;
      } else if (known) {
        return Fault{token.position, std::string(token.word) + " " + std::string(known->refusal), listed(words.all())};
      } else {
        return Fault{token.position, "nobody knows the name " + std::string(token.word), listed(words.all()),
                     std::string(token.word)};
      }
    } else if (token.kind == TokenKind::minus) {
      made.number = -parts[0].number;
    } else if (token.kind == TokenKind::negation) {
      made = {parts[0].number, true, !parts[0].negated};
    } else if (token.kind == TokenKind::call) {
      made.number = call(token, parts);
    } else if (token.kind == TokenKind::kept_sum) {
      auto sum = record_sum(*sums, static_cast<std::size_t>(token.value), tape, words, *summed);
      if (auto* fault = std::get_if<Fault>(&sum)) return Fault{token.position, fault->detail, fault->allowed};
      made.number = std::get<Symbol>(sum);
    } else if (token.kind >= TokenKind::less) {
      made = compare(token.kind, parts[0], parts[1]);
    } else {
      made.number = operate(token.kind, parts[0].number, parts[1].number);
    }
    stack.resize(stack.size() - count);
    if (!is_finite(made.number, tape, from)) return Fault{token.position, "is no finite number here"};
    if (tape.size() > static_cast<tape::Index>(most))
      return Fault{token.position, "takes too many operations", std::to_string(most) + " a scene"};
    stack.push_back(made);
  }
  if (stack.back().condition) return Fault{0, "is a condition and no number", "if(a < b, …, …)"};
  return stack.back().number;
}

}  // namespace least::text
