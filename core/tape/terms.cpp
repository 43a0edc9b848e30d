#include "core/tape/terms.hpp"

#include <algorithm>
#include <limits>

#include "core/tape/derivative.hpp"

namespace least::tape {
namespace {

/// Sorts operands so that variables go by their numbers: consecutive terms then mostly add to consecutive sums.
std::vector<Index> in_order_of_variables(const Tape& tape, std::vector<Index> operands) {
  constexpr double last = std::numeric_limits<double>::infinity();
  std::ranges::stable_sort(operands, {}, [&](Index i) { return tape[i].op == Op::variable ? tape[i].value : last; });
  return operands;
}

/// Returns the adjoint of a result if it is the same constant for all terms, else null.
const Symbol* common_adjoint(const Terms& terms, std::size_t result, std::span<const Symbol> adjoint) {
  const Symbol* common = nullptr;
  for (Index t = 0; t < terms.count; ++t) {
    const Index sum = terms.into[result * nth(terms.count) + nth(t)];
    if (sum == none) continue;
    const Symbol& one = adjoint[nth(sum)];
    if (!one.is_constant() || (common && common->constant() != one.constant())) return nullptr;
    common = &one;
  }
  return common;
}

}  // namespace

Tape tape_of(const Terms& terms) {
  Tape tape;
  for (const Node& node : terms.formula) tape.write(node);
  return tape;
}

std::vector<std::pair<Index, Symbol>> slopes_of_terms(Tape& tape, Index number, std::span<const Symbol> adjoint,
                                                      const std::function<bool(Index)>& wanted) {
  const Terms terms = tape.terms(number);  // a copy: what is written below may move the terms
  std::vector<Index> operands;
  std::ranges::copy_if(terms.operands, std::back_inserter(operands), wanted);
  operands = in_order_of_variables(tape, std::move(operands));
  std::vector<Index> sum_of(nth(tape.size()), none);
  for (std::size_t i = 0; i < operands.size(); ++i) sum_of[nth(operands[i])] = static_cast<Index>(i);

  Tape formula = tape_of(terms);
  Terms made{.formula = {},
             .results = {},
             .arguments = terms.arguments,
             .count = terms.count,
             .sums = static_cast<Index>(operands.size()),
             .given = terms.given,
             .into = {},
             .operands = {}};
  Symbol whole = 0;
  for (std::size_t r = 0; r < terms.results.size(); ++r) {
    const Symbol result = Symbol::at(formula, terms.results[r]);
    if (const Symbol* common = common_adjoint(terms, r, adjoint)) {
      whole = whole + *common * result;
      continue;
    }
    whole = whole + Symbol::variable(formula, nth(made.arguments++)) * result;
    for (Index t = 0; t < terms.count; ++t) {
      const Index sum = terms.into[r * nth(terms.count) + nth(t)];
      made.given.push_back((sum == none ? Symbol(0) : adjoint[nth(sum)]).on(tape));
    }
  }
  std::vector<int> moving;
  for (Index k = 0; k < terms.arguments; ++k) {
    const std::span column = std::span(terms.given).subspan(nth(k) * nth(terms.count), nth(terms.count));
    if (std::ranges::any_of(column, [&](Index i) { return sum_of[nth(i)] != none; })) moving.push_back(k);
  }
  const std::vector<Symbol> slopes = gradient(formula, whole, moving);
  Tape lean;
  Substitution same(formula, lean, [&](int i) { return Symbol::variable(lean, static_cast<std::size_t>(i)); });
  for (std::size_t k = 0; k < moving.size(); ++k) {
    if (slopes[k].is_constant() && slopes[k].constant() == 0) continue;
    made.results.push_back(same(slopes[k]).on(lean));
    for (Index t = 0; t < terms.count; ++t)
      made.into.push_back(sum_of[nth(terms.given[nth(moving[k]) * nth(terms.count) + nth(t)])]);
  }
  for (Index i = 0; i < lean.size(); ++i) made.formula.push_back(lean[i]);
  const Index kept = tape.keep(std::move(made));
  std::vector<std::pair<Index, Symbol>> all;
  for (std::size_t i = 0; i < operands.size(); ++i)
    all.emplace_back(operands[i], Symbol::total(tape, kept, static_cast<Index>(i)));
  return all;
}

}  // namespace least::tape
