// A form's tape with numbers in the place of its parameters, and what is made of that.
#pragma once

#include <limits>

#include "core/tape/derivative.hpp"
#include "core/tape/formula.hpp"
#include "core/text/form.hpp"

namespace least::text {

/// Folding copies symbols of a form to a tape of its own, with the parameters replaced by numbers. Not copyable: its
/// substitution refers to that tape.
class Folding {
 public:
  Folding(const Form& form, std::span<const double> parameters)
      : substitution_(form.tape, tape_, [this, parameters, first = form.numbers.parameter](int i) {
          return i < first ? Symbol::variable(tape_, static_cast<std::size_t>(i))
                           : Symbol(parameters[static_cast<std::size_t>(i - first)]);
        }) {}
  Folding(const Folding&) = delete;
  Folding& operator=(const Folding&) = delete;

  Symbol operator()(const Symbol& y) { return substitution_(y); }
  std::vector<Symbol> operator()(const std::vector<Symbol>& all) {
    std::vector<Symbol> folded;
    folded.reserve(all.size());
    for (const Symbol& y : all) folded.push_back(substitution_(y));
    return folded;
  }
  /// variable(i) returns the i-th variable of the form on the new tape.
  Symbol variable(int i) { return Symbol::variable(tape_, static_cast<std::size_t>(i)); }
  /// number(y) returns the value of a symbol of the form that depends on parameters alone; NaN for any other.
  double number(const Symbol& y) {
    const Symbol folded = substitution_(y);
    return folded.is_constant() ? folded.constant() : std::numeric_limits<double>::quiet_NaN();
  }
  std::vector<double> numbers(const std::vector<Symbol>& all) {
    std::vector<double> found;
    found.reserve(all.size());
    for (const Symbol& y : all) found.push_back(number(y));
    return found;
  }
  /// gradient(folded, variables) differentiates a symbol of the new tape.
  std::vector<Symbol> gradient(const Symbol& folded, std::span<const int> variables) {
    return tape::gradient(tape_, folded, variables);
  }
  /// formula_of takes symbols of the new tape; formula, below, takes symbols of the form.
  tape::Formula formula_of(std::span<const Symbol> folded) {
    std::vector<tape::Index> places;
    for (const Symbol& y : folded) places.push_back(y.on(tape_));
    return {tape_, places};
  }
  tape::Formula formula(const std::vector<Symbol>& all) { return formula_of((*this)(all)); }
  tape::Formula formula(const Symbol& y) { return formula(std::vector{y}); }

 private:
  tape::Tape tape_;
  tape::Substitution substitution_;
};

}  // namespace least::text
