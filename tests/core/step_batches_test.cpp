// Steps of a program that are computed side by side: they have the bits of steps computed one by one, and scenes of
// many bodies have many of them together.
#include "core/tape/step_batches.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "core/tape/series.hpp"
#include "core/tape/series_reading.hpp"
#include "core/tape/symbol.hpp"

namespace least::tape {
namespace {

/// Copies are independent motions of three variables each, with different constants, that use every rule. No product
/// occurs in two sums, which would make it a value of its own.
struct Copies {
  explicit Copies(std::size_t count) {
    for (std::size_t n = 0; n < count; ++n) {
      const Symbol x = Symbol::variable(tape, 3 * n), y = Symbol::variable(tape, 3 * n + 1),
                   z = Symbol::variable(tape, 3 * n + 2);
      const double shift = 1 + 0.25 * static_cast<double>(n);
      const Symbol square = x * x + y * y + shift;
      rates.push_back((pow(square, -1.5) * y - exp(-shift * z)).on(tape));
      rates.push_back((sin(shift * x) * z + sqrt(square) / (x + 3 * shift)).on(tape));
      rates.push_back((atan(z) * log(square) - tanh(z) + shift * x).on(tape));
      for (const double start : {0.3, -0.7, 0.2}) y0.push_back(start + 0.1 * static_cast<double>(n));
    }
  }
  Series series(int order) const { return {Program(tape, rates, rates.size()), order}; }

  Tape tape;
  std::vector<Index> rates;
  std::vector<double> y0;
};

struct Variables {
  std::vector<Symbol> x;
  std::vector<double> y0;
};
/// variables() returns `count` variables, whose values begin at 1 and increase by `apart`.
Variables variables(Tape& tape, std::size_t count, double apart) {
  Variables made;
  for (std::size_t i = 0; i < count; ++i) {
    made.x.push_back(Symbol::variable(tape, i));
    made.y0.push_back(1 + apart * static_cast<double>(i));
  }
  return made;
}

TEST(StepBatches, AreComputedToTheBitsOfStepsOneByOne) {
  constexpr int order = 15;
  const Copies few(2), many(19);  // two copies are not batched; nineteen leave the last register partly filled
  Program program(many.tape, many.rates, many.rates.size());
  const StepBatches batches(program);
  std::size_t together = 0;
  for (const StepBatch& batch : batches.batches) together += batch.count;
  ASSERT_EQ(together, program.steps.size());
  Series one_by_one = few.series(order), side_by_side = many.series(order);
  one_by_one.expand(few.y0.data(), 0.5);
  side_by_side.expand(many.y0.data(), 0.5);
  for (int k = 0; k <= order; ++k)
    for (std::size_t i = 0; i < few.y0.size(); ++i) {
      ASSERT_TRUE(std::isfinite(one_by_one.coefficients(k)[i]));
      EXPECT_EQ(side_by_side.coefficients(k)[i], one_by_one.coefficients(k)[i]) << "variable " << i << " order " << k;
    }
  EXPECT_NE(one_by_one.coefficients(order)[0], one_by_one.coefficients(order)[3]);
}

/// Thirty powers, of which the eleventh reads a variable far from that of the tenth, so that there are two batches: the
/// lanes that fill up the last register of the second one must not overwrite computed values. The variables depend on
/// each other in cycles of three, so that three of them are a system of their own for comparison.
TEST(StepBatches, FillUpNothingThatIsRead) {
  constexpr std::size_t n = 30, far = 20;
  constexpr int order = 12;
  const auto series = [&](std::span<const std::size_t> variables, std::span<const std::size_t> read,
                          std::size_t& parts) {
    Tape tape;
    std::vector<Index> rates;
    std::vector<double> y0;
    for (const std::size_t i : read) rates.push_back(pow(Symbol::variable(tape, i), -1.5).on(tape));
    for (const std::size_t i : variables) y0.push_back(1 + 0.03 * static_cast<double>(i));
    Program program(tape, rates, rates.size());
    Series made(program, order);
    parts = StepBatches(program).batches.size();
    made.expand(y0.data(), 0);
    return made;
  };
  std::vector<std::size_t> all, read;
  for (std::size_t i = 0; i < n; ++i) {
    all.push_back(i);
    read.push_back((i + far) % n);
  }
  std::size_t parts = 0;
  const Series together = series(all, read, parts);
  ASSERT_EQ(parts, 2);
  const Series alone = series(std::array<std::size_t, 3>{0, 20, 10}, std::array<std::size_t, 3>{1, 2, 0}, parts);
  ASSERT_EQ(parts, 0);
  for (int k = 0; k <= order; ++k) EXPECT_EQ(together.coefficients(k)[0], alone.coefficients(k)[0]) << k;
}

/// rows_by() returns all rows of all orders, computed in registers of at most `widest` numbers.
std::vector<double> rows_by(std::size_t widest, const Copies& copies, int order) {
  Program program(copies.tape, copies.rates, copies.rates.size());
  SeriesReading reading(program, widest);
  const std::size_t stride = reading.stride();
  std::vector<double> rows((static_cast<std::size_t>(order) + 1) * stride);
  std::ranges::copy(copies.y0, rows.begin() + Program::first_variable);
  reading.begin(program, rows.data(), false);
  reading.expand(program, {static_cast<std::size_t>(order), stride, nullptr, 0, nullptr, rows.data(), nullptr});
  std::vector<double> found;
  for (int k = 0; k <= order; ++k)
    for (std::size_t i = 0; i < copies.y0.size(); ++i)
      found.push_back(
          rows[static_cast<std::size_t>(k) * stride + static_cast<std::size_t>(Program::first_variable) + i]);
  return found;
}

TEST(StepBatches, DoNotDependOnTheWidthOfRegisters) {
  const Copies copies(19);
  const std::vector<double> by_two = rows_by(2, copies, 15);
  for (const double number : by_two) ASSERT_TRUE(std::isfinite(number));
  EXPECT_EQ(rows_by(4, copies, 15), by_two);
  EXPECT_EQ(rows_by(8, copies, 15), by_two);
}

/// A program that is in order already does not change when it is read again, as it is where only the tolerance differs.
TEST(StepBatches, PutAProgramInOrderOnce) {
  const Copies copies(19);
  Program program(copies.tape, copies.rates, copies.rates.size());
  const StepBatches once(program);
  const Index rows = program.rows;
  const std::size_t lanes = program.lane_a.size();
  const StepBatches again(program);
  EXPECT_EQ(program.rows, rows);
  EXPECT_EQ(program.lane_a.size(), lanes);
  EXPECT_EQ(again.copied.size(), once.copied.size());
}

/// Quantities that are carried beside a motion do not change its bits, although only with them there are so many steps,
/// or products that two sums share, that products become values of their own.
TEST(StepBatches, LeaveTheMotionAsItIsWithoutWhatIsCarried) {
  constexpr std::size_t n = 60;
  constexpr int order = 8;
  Tape tape;
  const Variables start = variables(tape, n, 0.01);
  const std::vector<Symbol>& x = start.x;
  std::vector<double> y0 = start.y0;
  std::vector<Index> rates;
  Symbol carried = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Symbol product = x[i] * x[(i + 7) % n];
    rates.push_back((0.3 * product - 0.1 * x[i]).on(tape));
    carried += product * 0.7 + sqrt(product) / x[i];
  }
  const auto series = [&](std::size_t all) {
    Series made(Program(tape, std::span(rates).first(all), n), order);
    made.expand(y0.data(), 0);
    return made;
  };
  const Series alone = series(n);
  rates.push_back(carried.on(tape));
  y0.push_back(0);
  const Series with = series(n + 1);
  for (int k = 0; k <= order; ++k)
    for (std::size_t i = 0; i < n; ++i) EXPECT_EQ(with.coefficients(k)[i], alone.coefficients(k)[i]) << k;
}

/// A batch whose lanes begin between other lanes, and whose last register is filled up behind all of them.
TEST(StepBatches, ReadWholeRegistersOfLanes) {
  constexpr std::size_t n = 8;
  Tape tape;
  auto [x, y0] = variables(tape, 2 * n, 0.1);
  std::vector<Index> rates;
  for (std::size_t i = 0; i < n; ++i)
    rates.push_back((i < 2 ? x[i] * x[n + i] : x[i] * x[n + i] + 0.5 * x[i]).on(tape));
  for (std::size_t i = 0; i < n; ++i) rates.push_back(x[i].on(tape));
  Series series(Program(tape, rates, 2 * n), 3);
  series.expand(y0.data(), 0);
  for (std::size_t i = 0; i < n; ++i) {  // x″ = x′y + x x (+ ½ x′)
    const double rate = y0[i] * y0[n + i] + (i < 2 ? 0 : 0.5 * y0[i]);
    const double bend = rate * y0[n + i] + y0[i] * y0[i] + (i < 2 ? 0 : 0.5 * rate);
    EXPECT_NEAR(series.coefficients(2)[i], bend / 2, 1e-13) << i;
  }
}

/// Values that depend on time alone stay right where products become values of their own.
TEST(StepBatches, LeaveWhatIsLinearInTimeAsItIs) {
  constexpr std::size_t n = 40;
  Tape tape;
  const Symbol t = Symbol::time(tape);
  auto [x, y0] = variables(tape, n, 0.1);
  std::vector<Index> rates;
  for (std::size_t i = 0; i < n; ++i) {
    const Symbol both = x[i] * x[(i + 1) % n], before = x[(i + n - 1) % n] * x[i];
    rates.push_back((both - before + 2 / (3 * t + static_cast<double>(i + 1))).on(tape));
  }
  Series series(Program(tape, rates, n), 3);
  series.expand(y0.data(), 0.5);
  for (std::size_t i = 0; i < n; ++i) {
    const double rate = y0[i] * (y0[(i + 1) % n] - y0[(i + n - 1) % n]) + 2 / (2.5 + static_cast<double>(i));
    EXPECT_NEAR(series.coefficients(1)[i], rate, 1e-13);
  }
}

/// For all pairs of bodies in space the common parts of the pairs are contiguous. Only the reading of positions and the
/// summing of forces are gathered.
TEST(StepBatches, PairsOfBodiesStandTogether) {
  constexpr std::size_t bodies = 9, pairs = bodies * (bodies - 1) / 2, coordinates = 3 * bodies;
  Tape tape;
  std::vector<Symbol> x, force(coordinates, Symbol(0));
  for (std::size_t i = 0; i < 2 * coordinates; ++i) x.push_back(Symbol::variable(tape, i));
  for (std::size_t i = 0; i < bodies; ++i)
    for (std::size_t j = i + 1; j < bodies; ++j) {
      Symbol square = 0;
      for (std::size_t c = 0; c < coordinates; c += bodies) square += (x[c + i] - x[c + j]) * (x[c + i] - x[c + j]);
      const Symbol pull = static_cast<double>(2 + i + j) * pow(square, -1.5);
      for (std::size_t c = 0; c < coordinates; c += bodies) {
        force[c + i] = force[c + i] - pull * (x[c + i] - x[c + j]);
        force[c + j] = force[c + j] + pull * (x[c + i] - x[c + j]);
      }
    }
  std::vector<Index> rates;
  for (std::size_t i = 0; i < coordinates; ++i) rates.push_back(x[coordinates + i].on(tape));
  for (const Symbol& f : force) rates.push_back(f.on(tape));
  Program program(tape, rates, rates.size());
  const StepBatches batches(program);
  const auto is_gathered = [](const StepBatches::Product& term) {
    return term.a.gathered || term.b.gathered || term.lane.gathered;
  };
  std::size_t products = 0, powers = 0;
  for (const StepBatch& batch : batches.batches) {
    for (Index i = 0; i < batch.products; ++i) {
      products += batch.count;
      EXPECT_FALSE(is_gathered(batches.products[static_cast<std::size_t>(batch.first_product + i)]));
    }
    if (batch.rule != Rule::power) continue;
    powers += batch.count;
    EXPECT_FALSE(batch.a.gathered || batch.b.gathered || batch.w.gathered || batch.lane.gathered);
  }
  EXPECT_EQ(products, 6 * pairs) << "three squares of a pair, and three parts of its pull, which two bodies share";
  EXPECT_EQ(powers, pairs);
  EXPECT_TRUE(batches.copied.empty());
}

}  // namespace
}  // namespace least::tape
