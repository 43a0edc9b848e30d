// Derivatives of Taylor series by the initial values and by parameters: every rule against differences of series, and
// second derivatives against differences of the first.
#include "core/tape/tangents.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "core/tape/step_tangents.hpp"
#include "core/tape/symbol.hpp"

namespace {

using least::Symbol;
using least::tape::Index;
using least::tape::Program;
using least::tape::Series;
using least::tape::StepTangents;
using least::tape::Tangents;
using least::tape::Tape;

constexpr int order = 12;
constexpr std::size_t all_variables = 3, moving = 2;  // x, y, and a parameter c
constexpr double later = 0.1;
using Start = std::array<double, all_variables>;

/// Ended is the state of ẋ = f(x, y, c, t), ẏ = xy − x/2 after the time `later`, with its derivatives by x, y, c and by
/// pairs of them.
struct Ended {
  std::array<double, moving> state{};
  std::array<std::array<double, all_variables>, moving> first{};
  std::array<std::vector<double>, moving> second{};
};

template <class F>
class Motion {
 public:
  explicit Motion(F f) {
    Tape tape;
    const Symbol x = Symbol::variable(tape, 0), y = Symbol::variable(tape, 1), c = Symbol::variable(tape, 2);
    const std::array<Symbol, all_variables> rates{f(x, y, c, Symbol::time(tape)), x * y - 0.5 * x, 0.0};
    std::vector<Index> places;
    for (const Symbol& rate : rates) places.push_back(rate.on(tape));
    program_ = Program(tape, places, moving);
    for (std::size_t a = 0; a < all_variables; ++a)
      for (std::size_t b = a; b < all_variables; ++b) pairs_.emplace_back(a, b);
  }

  /// from() expands from `start`. The first derivatives are propagated multiplied by `scale` (those by pairs are not
  /// scaled), which must not change the result.
  Ended from(const Start& start, double scale = 1) const {
    Series series(program_, order, false);
    series.expand(start.data(), 0.2);
    Tangents tangents(series.program(), order, all_variables, pairs_);
    constexpr std::size_t lanes = Tangents::lanes_of(all_variables);
    const std::size_t pair_lanes = Tangents::lanes_of(pairs_.size());
    std::vector<double> first(all_variables * lanes), second(all_variables * pair_lanes);
    for (std::size_t i = 0; i < all_variables; ++i) first[i * lanes + i] = scale;
    tangents.expand(series, first, second, std::vector<double>(pair_lanes, 1 / (scale * scale)));
    std::vector<double> low(first.size()), low_second(second.size());
    tangents.evaluate(later, first, low, second, low_second);
    Ended ended;
    for (std::size_t i = 0; i < moving; ++i) {
      for (int k = order; k >= 0; --k) ended.state[i] = ended.state[i] * later + series.coefficients(k)[i];
      for (std::size_t d = 0; d < all_variables; ++d) ended.first[i][d] = first[i * lanes + d] / scale;
      for (std::size_t p = 0; p < pairs_.size(); ++p) ended.second[i].push_back(second[i * pair_lanes + p]);
    }
    return ended;
  }
  const std::vector<Tangents::Pair>& pairs() const { return pairs_; }
  const Program& program() const { return program_; }

 private:
  Program program_;
  std::vector<Tangents::Pair> pairs_;
};

template <class F>
void holds(const char* what, F f) {
  SCOPED_TRACE(what);
  const Motion<F> motion(f);
  const Start start{0.4, 0.7, 0.6};
  const Ended found = motion.from(start), scaled = motion.from(start, 0x1p40);
  constexpr double step = 1e-3;
  const auto moved = [&](std::size_t d, double by) {
    Start there = start;
    there[d] += by;
    return motion.from(there);
  };
  for (std::size_t d = 0; d < all_variables; ++d) {
    const Ended up = moved(d, step), down = moved(d, -step), far_up = moved(d, 2 * step),
                far_down = moved(d, -2 * step);
    const auto slope = [&](auto number) {
      return (8 * (number(up) - number(down)) - (number(far_up) - number(far_down))) / (12 * step);
    };
    for (std::size_t i = 0; i < moving; ++i) {
      const double first = slope([&](const Ended& ended) { return ended.state[i]; });
      EXPECT_NEAR(found.first[i][d], first, 1e-9 * (1 + std::abs(first))) << i << " by " << d;
      EXPECT_EQ(scaled.first[i][d], found.first[i][d]);
      for (std::size_t p = 0; p < motion.pairs().size(); ++p) {
        const auto [a, b] = motion.pairs()[p];
        if (b != d) continue;
        const double second = slope([&](const Ended& ended) { return ended.first[i][a]; });
        EXPECT_NEAR(found.second[i][p], second, 1e-9 * (1 + std::abs(second))) << i << " by " << a << " and " << b;
        EXPECT_EQ(scaled.second[i][p], found.second[i][p]);
      }
    }
  }
}

/// The same derivatives by steps side by side, from different starts, for two numbers of steps.
template <class F>
void holds_side_by_side(const char* what, F f) {
  SCOPED_TRACE(what);
  const Motion<F> motion(f);
  if (!StepTangents::suits(motion.program())) return;
  StepTangents tangents(motion.program(), order);
  for (const std::size_t count : {StepTangents::steps, std::size_t{3}}) {
    std::vector<double> starts, times(count, 0.2), lengths;
    std::vector<Ended> alone;
    for (std::size_t step = 0; step < count; ++step) {
      const double by = 0.02 * static_cast<double>(step);
      const Start start{0.4 + by, 0.7 - by, 0.6 + by / 2};
      starts.insert(starts.end(), start.begin(), start.end());
      lengths.push_back(later);
      alone.push_back(motion.from(start));
    }
    tangents.expand(starts, times);
    tangents.find_changes(lengths);
    std::array<double, moving * all_variables> within;
    for (std::size_t step = 0; step < count; ++step) {
      tangents.change_in(later, step, within.data());
      for (std::size_t i = 0; i < moving; ++i)
        for (std::size_t c = 0; c < all_variables; ++c) {
          const double change = tangents.change(step)[i * all_variables + c];
          const double right = alone[step].first[i][c] - (i == c ? 1 : 0);
          EXPECT_NEAR(change, right, 1e-13 * (1 + std::abs(right))) << step << ": " << i << " by " << c;
          EXPECT_EQ(within[i * all_variables + c], change);
        }
    }
  }
}

TEST(Tangents, OfEveryRuleAreDifferencesOfItsSeries) {
  using least::pow, least::sqrt, least::exp, least::log, least::sin, least::cos, least::tan, least::sinh, least::cosh;
  using least::tanh, least::atan, least::asin, least::acos, least::select;
  const auto with = [](const char* what, auto f) {
    const auto of_sum = [f](const Symbol& x, const Symbol& y, const Symbol& c, const Symbol&) {
      return f(c * x + y * y);
    };
    holds(what, of_sum);
    holds_side_by_side(what, of_sum);
  };
  with("a square", [](const Symbol& u) { return u * u; });
  with("a sum", [](const Symbol& u) { return 2.0 * u + 1.0; });
  with("a quotient", [](const Symbol& u) { return u / (1.0 + u * u); });
  with("an inverse", [](const Symbol& u) { return 2.0 / (u + exp(u)); });
  with("a root", [](const Symbol& u) { return sqrt(u); });
  with("a power", [](const Symbol& u) { return pow(u, -1.5); });
  with("an inverse power", [](const Symbol& u) { return pow(u, -1.0); });
  with("exp", [](const Symbol& u) { return exp(u); });
  with("log", [](const Symbol& u) { return log(u); });
  with("sin and cos", [](const Symbol& u) { return sin(u) + 2.0 * cos(3.0 * u); });
  with("tan", [](const Symbol& u) { return tan(u); });
  with("sinh and cosh", [](const Symbol& u) { return sinh(u) * cosh(u); });
  with("tanh", [](const Symbol& u) { return tanh(u); });
  with("atan", [](const Symbol& u) { return atan(u); });
  with("asin", [](const Symbol& u) { return asin(0.5 * u); });
  with("acos", [](const Symbol& u) { return acos(0.5 * u); });
  with("a choice", [](const Symbol& u) { return select(u < Symbol(0.1), exp(u), u * u); });
  const auto all = [](const char* what, auto f) {
    holds(what, f);
    holds_side_by_side(what, f);
  };
  using S = const Symbol&;
  all("a product", [](S x, S y, S c, S) { return x * y * c; });
  all("a parameter alone", [](S, S, S c, S) { return sin(c) * c + 1.0 / c; });
  all("a power of a parameter", [](S x, S y, S c, S) { return pow(x, c) + pow(y, 2.0 * c); });
  all("what is linear in time", [](S x, S y, S c, S t) { return t * x * y + c * x / (2.0 + t); });
  all("a function of the time", [](S x, S, S c, S t) { return sin(3.0 * t) * x + pow(1.0 + t, 1.5) * c + cos(c * t); });
  all("nothing but the time", [](S, S, S, S t) { return exp(t); });
}

}  // namespace
