// The functions that a text can call, and how tightly its operations bind.
#pragma once

#include <algorithm>
#include <array>
#include <string_view>

#include "core/text/expression.hpp"

namespace least::text {

inline constexpr std::array<std::string_view, 20> functions{"sin",  "cos",  "tan", "asin",  "acos",  "atan", "sinh",
                                                            "cosh", "tanh", "exp", "log",   "sqrt",  "abs",  "ln",
                                                            "sign", "min",  "max", "atan2", "hypot", "if"};
/// number_of returns the index of a function in `functions`; their number for other names.
constexpr std::size_t number_of(std::string_view function) {
  return static_cast<std::size_t>(std::find(functions.begin(), functions.end(), function) - functions.begin());
}
/// Arity is how many arguments a function takes, at least and at most.
struct Arity {
  std::size_t least = 1, most = 1;
};
constexpr Arity arity(std::size_t function) {
  if (function == number_of("min") || function == number_of("max")) return {2, 64};
  if (function == number_of("atan2") || function == number_of("hypot")) return {2, 2};
  return function == number_of("if") ? Arity{3, 3} : Arity{};
}

/// The beginning of the markup of a sum or a product over indices, by which its open right end is recognised.
inline constexpr std::string_view series_markup = "<mrow><munderover>";

/// Precedence of an operation: the one with the larger `binds` is done first; of equal ones the left one, unless they
/// are `right`-associative.
struct Precedence {
  int binds;
  bool right = false;
};
constexpr Precedence precedence(Token::Kind kind) {
  switch (kind) {
    case Token::Kind::add:
    case Token::Kind::subtract:
      return {1};
    case Token::Kind::multiply:
    case Token::Kind::divide:
      return {2};
    case Token::Kind::minus:
      return {3, true};
    case Token::Kind::power:
      return {4, true};
    case Token::Kind::negation:
      return {-1, true};
    case Token::Kind::conjunction:
      return {-2};
    case Token::Kind::disjunction:
      return {-3};
    default:
      return {0};
  }
}

}  // namespace least::text
