// Sums of many terms of one form: their bits do not depend on the width of the machine's registers.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "core/tape/derivative.hpp"
#include "core/tape/formula.hpp"

namespace {

using least::Symbol;
using least::tape::Formula;
using least::tape::Index;
using least::tape::Tape;
using least::tape::Terms;

/// attraction() returns Σ w_ij/√((x_i − x_j)² + (y_i − y_j)² + 1/4) with weights that differ, over all pairs i < j, or
/// over one j for each i.
Symbol attraction(Tape& tape, int bodies, bool of_pairs) {
  Tape formula;
  std::vector<Symbol> a;
  for (std::size_t k = 0; k < 5; ++k) a.push_back(Symbol::variable(formula, k));
  const Symbol dx = a[0] - a[1], dy = a[2] - a[3], term = a[4] / sqrt(dx * dx + dy * dy + 0.25);
  Terms terms;
  for (Index i = 0; i < formula.size(); ++i) terms.formula.push_back(formula[i]);
  terms.results = {term.place()};
  terms.arguments = 5;
  terms.sums = 1;
  std::vector<std::vector<Index>> given(5);
  for (int i = 0; i < bodies; ++i)
    for (int j = of_pairs ? i + 1 : (7 * i + 3) % bodies, end = of_pairs ? bodies : j + 1; j < end; ++j) {
      const int places[] = {i, j, bodies + i, bodies + j};
      for (std::size_t k = 0; k < 4; ++k)
        given[k].push_back(Symbol::variable(tape, static_cast<std::size_t>(places[k])).place());
      given[4].push_back(Symbol(1.0 / (1 + i + 2 * j)).on(tape));
      terms.into.push_back(0);
      ++terms.count;
    }
  for (const auto& column : given) terms.given.insert(terms.given.end(), column.begin(), column.end());
  return Symbol::total(tape, tape.keep(std::move(terms)), 0);
}

/// bits_of() combines the bits of the sum and of its gradient in one number; only roots, quotients, products and sums
/// occur, which every machine rounds alike.
std::uint64_t bits_of(int bodies, bool of_pairs) {
  Tape tape;
  const Symbol whole = attraction(tape, bodies, of_pairs);
  std::vector<int> all(2 * static_cast<std::size_t>(bodies));
  std::iota(all.begin(), all.end(), 0);
  std::vector<Index> outputs{whole.place()};
  for (const Symbol& slope : gradient(tape, whole, all)) outputs.push_back(slope.on(tape));
  const Formula formula(tape, outputs);
  std::vector<double> x(all.size()), out(outputs.size());
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = static_cast<double>(i * 7919 % 1009) / 1009;
  formula.evaluate(x.data(), 0.0, out.data());
  std::uint64_t all_bits = 0;
  for (const double y : out) all_bits = std::rotl(all_bits, 1) ^ std::bit_cast<std::uint64_t>(y);
  return all_bits;
}

// The expected numbers were the same with registers of two, four and eight doubles; builds with sanitizers have
// registers of two only.
TEST(Terms, HaveTheSameBitsWhateverTheRegisters) {
  EXPECT_EQ(bits_of(50, true), 11196396790541927292u);
  EXPECT_EQ(bits_of(300, false), 9917009427886897081u);
}

/// squares() returns Σ (a x_i)² over `count` variables; a is a constant or a value that the formula has to compute.
Symbol squares(Tape& tape, int count, const Symbol& a) {
  Tape formula;
  const Symbol x = Symbol::variable(formula, 0), by = Symbol::variable(formula, 1), term = by * x * (by * x);
  Terms terms;
  for (Index i = 0; i < formula.size(); ++i) terms.formula.push_back(formula[i]);
  terms.results = {term.place()};
  terms.arguments = 2;
  terms.sums = 1;
  terms.count = count;
  for (int i = 0; i < count; ++i) terms.given.push_back(Symbol::variable(tape, static_cast<std::size_t>(i)).place());
  terms.given.resize(2 * terms.given.size(), a.on(tape));
  terms.into.assign(static_cast<std::size_t>(count), 0);
  return Symbol::total(tape, tape.keep(std::move(terms)), 0);
}

// Sums that depend on variables and constants alone are prepared once for all formulas of a tape. A sum that depends on
// a value computed in a formula is not shared, because each formula has that value in another register.
TEST(Terms, AreSharedByFormulasUnlessTheyReadWhatOneHasComputed) {
  constexpr int count = 40;
  const std::vector<double> x(count, 0.5);
  for (const bool computed : {false, true}) {
    Tape tape;
    const Symbol y = Symbol::variable(tape, 0);
    const Symbol sum = squares(tape, count, computed ? sin(y) : Symbol(2.0));
    least::tape::SharedSums shared;
    double expected = 0;
    const auto value = [&](const Symbol& of) {
      const Index output = of.on(tape);
      double result = 0;
      Formula(tape, std::span(&output, 1), &shared).evaluate(x.data(), 0.0, &result);
      return result;
    };
    for (const double xi : x) expected += (computed ? std::sin(0.5) : 2) * xi * ((computed ? std::sin(0.5) : 2) * xi);
    EXPECT_DOUBLE_EQ(value(sum), expected);
    EXPECT_DOUBLE_EQ(value(cos(y) * exp(y) - sum), std::cos(0.5) * std::exp(0.5) - expected);
    EXPECT_EQ(shared.size(), computed ? 0 : 1);
  }
}

/// every_operation returns values of the variables x, y and of the time t, with every operation of a formula in them.
std::vector<Symbol> every_operation(Tape& tape) {
  const Symbol x = Symbol::variable(tape, 0), y = Symbol::variable(tape, 1), t = Symbol::time(tape);
  const Symbol r = sqrt(x * x + y * y), half = x / (1 + r);
  return {x + y - t,
          3.0 - x * 2.0,
          1.0 / y + half,
          pow(r, 1.5),
          exp(half) + log(r) + tanh(y),
          sin(x + t) * cos(y) + tan(half),
          sinh(half) - cosh(half),
          atan(x) + asin(half) - acos(half),
          select(x < y, x * y, t),
          x,
          Symbol(2.5)};
}

// Rows are computed many at a time, with the bits of one at a time, also with sums of terms.
TEST(Formula, HasTheSameBitsInRowsAsAlone) {
  for (const bool with_terms : {false, true}) {
    Tape tape;
    std::vector<Index> outputs;
    for (const Symbol& value : every_operation(tape)) outputs.push_back(value.on(tape));
    if (with_terms) outputs.push_back(attraction(tape, 3, true).place());
    const Formula formula(tape, outputs);
    const std::size_t width = 9, values = formula.outputs();
    for (const std::size_t count : {1, 2, 31, 32, 33, 100}) {
      std::vector<double> rows(count * width), together(count * values), alone(values);
      for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = 0.1 + static_cast<double>(i * 7919 % 1009) / 1009;
      formula.evaluate_rows(rows.data(), width, count, together.data());
      for (std::size_t row = 0; row < count; ++row) {
        formula.evaluate(rows.data() + row * width + 1, rows[row * width], alone.data());
        for (std::size_t k = 0; k < values; ++k)
          EXPECT_EQ(std::bit_cast<std::uint64_t>(together[row * values + k]), std::bit_cast<std::uint64_t>(alone[k]))
              << "row " << row << " of " << count << ", value " << k;
      }
    }
  }
}

}  // namespace
