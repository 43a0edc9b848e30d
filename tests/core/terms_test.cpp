// Sums of terms alike: their bits, which do not depend on the registers of the machine.
#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <numeric>
#include <vector>

#include "core/tape/derivative.hpp"
#include "core/tape/formula.hpp"

namespace {

using least::Symbol;
using least::tape::Formula;
using least::tape::Index;
using least::tape::Tape;
using least::tape::Terms;

/// Σ w_ij/√((x_i − x_j)² + (y_i − y_j)² + 1/4) over pairs i < j, whose weights differ, or over each with one other.
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

/// The bits of the sum and of its slopes, in one number: roots, quotients, products and sums alone are in them.
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

// The numbers stand here as registers of two, four and eight found them: where sanitizers watch, there are those of
// two.
TEST(Terms, HaveTheSameBitsWhateverTheRegisters) {
  EXPECT_EQ(bits_of(50, true), 11196396790541927292u);
  EXPECT_EQ(bits_of(300, false), 9917009427886897081u);
}

}  // namespace
