#include "core/tape/formula.hpp"

#include <cmath>
#include <cstring>
#include <string>
#include <variant>
#include <vector>

#include "core/text/expression.hpp"
#include "core/text/print.hpp"
#include "tests/fuzz/targets.hpp"

namespace least::fuzz {
namespace {

using text::Expression;

std::variant<Symbol, text::Fault> record(const Expression& expression, tape::Tape& tape) {
  const text::Word words[] = {{"x", Symbol::variable(tape, 0)},
                              {"y", Symbol::variable(tape, 1)},
                              {"t", Symbol::time(tape)},
                              {"z", Symbol(0.0), "is not for here"}};
  return expression.record(tape, words);
}

double value_of(const Symbol& symbol, tape::Tape& tape) {
  const tape::Index place = symbol.on(tape);
  const double at[] = {0.7, 1.3};
  double value = 0;
  tape::Formula(tape, std::span(&place, 1)).evaluate(at, 0.4, &value);
  return value;
}

void check(const text::Fault& fault, std::size_t size) {
  ensure(fault.position <= size, "a fault beyond the end");
  ensure(!fault.detail.empty(), "a fault without a word");
}

// Every element is closed, the last one first.
void check_markup(std::string_view markup) {
  std::vector<std::string_view> open;
  for (auto at = markup.find('<'); at != markup.npos; at = markup.find('<', at + 1)) {
    const auto end = markup.find('>', at);
    ensure(end != markup.npos, "an element without its end");
    const std::string_view name = markup.substr(at + 1, end - at - 1);
    if (name.starts_with('/')) {
      ensure(!open.empty() && open.back() == name.substr(1), "an element closed that is not open");
      open.pop_back();
    } else {
      open.push_back(name);
    }
  }
  ensure(open.empty(), "an element that is not closed");
}

}  // namespace

void formula(std::string_view bytes) {
  const auto parsed = Expression::parse(std::string(bytes));
  if (const auto* const fault = std::get_if<text::Fault>(&parsed)) return check(*fault, bytes.size());
  const auto& read = std::get<Expression>(parsed);
  check_markup(read.mathml([](std::string_view name) { return "<mi>" + std::string(name) + "</mi>"; }));
  tape::Tape tape;
  const auto made = record(read, tape);
  if (const auto* const fault = std::get_if<text::Fault>(&made)) return check(*fault, bytes.size());
  const auto& symbol = std::get<Symbol>(made);
  const std::string printed = text::print(tape, symbol, [](int i) { return std::string(i == 0 ? "x" : "y"); });
  if (printed.find("…") != printed.npos) return;  // too long to be shown
  const auto reparsed = Expression::parse(printed);
  ensure(std::holds_alternative<Expression>(reparsed), "what is printed cannot be read: " + printed);
  tape::Tape other;
  const auto again = record(std::get<Expression>(reparsed), other);
  ensure(std::holds_alternative<Symbol>(again), "what is printed cannot be recorded: " + printed);
  const double was = value_of(symbol, tape), is = value_of(std::get<Symbol>(again), other);
  const bool same = was == is || (std::isnan(was) && std::isnan(is));
  ensure(same, "what is printed has another value: " + printed);
}

}  // namespace least::fuzz
