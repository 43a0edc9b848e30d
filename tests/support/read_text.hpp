// A formula that is read as text and evaluated at one point.
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "core/tape/formula.hpp"
#include "core/text/expression.hpp"

namespace reading {

using namespace least;

/// The values of x, y and t at the point where formulas are evaluated.
inline constexpr double x_here = 1.25, y_here = 3, t_here = 0.5;

struct ReadText {
  std::optional<text::Fault> fault;
  double value = 0;
};
inline ReadText read(const std::string& typed) {
  const auto parsed = text::Expression::parse(typed);
  if (const auto* fault = std::get_if<text::Fault>(&parsed)) return {*fault};
  tape::Tape tape;
  const text::Word words[] = {{"x", Symbol::variable(tape, 0)},
                              {"y", Symbol::variable(tape, 1)},
                              {"t", Symbol::time(tape)},
                              {"k", Symbol(2.0)},
                              {"s", Symbol(), "is no part of this"}};
  const auto recorded = std::get<text::Expression>(parsed).record(tape, words);
  if (const auto* fault = std::get_if<text::Fault>(&recorded)) return {*fault};
  const tape::Index output[] = {std::get<Symbol>(recorded).on(tape)};
  const double variables[] = {x_here, y_here};
  double value = 0;
  tape::Formula(tape, output).evaluate(variables, t_here, &value);
  return {std::nullopt, value};
}

}  // namespace reading
