// The splittings for weak forces: their coefficients against the order conditions in quad precision, and their gain on
// a motion that is nearly free.
#include <gtest/gtest.h>

#include <cmath>

#include "core/number/quad.hpp"
#include "core/schemes/contact_splitting.hpp"
#include "tests/support/contact_data.hpp"

namespace {

using namespace least;
using contact::pi;

/// defect() returns the error of an order condition: the sum over kicks i ≤ j ≤ … of b_i c_i^p b_j c_j^q … with r equal
/// indices weighted by 1/r!, less the integral of x^p y^q … over 0 < x < y < … < 1.
double defect(const Alternation<Quad>& turns, const std::vector<int>& powers) {
  const auto n = static_cast<std::size_t>(turns.stages);
  Quad exact(1), sum(0);
  int degree = 0;
  for (const int power : powers) exact /= degree += power + 1;
  const auto add = [&](const auto& self, std::size_t which, std::size_t from, int same, Quad term) -> void {
    if (which == powers.size()) {
      sum += term;
      return;
    }
    for (std::size_t i = from; i < n; ++i) {
      const int times = which > 0 && i == from ? same + 1 : 1;
      Quad next = term * turns.kick[i] / times;
      for (int k = 0; k < powers[which]; ++k) next *= turns.middle[i];
      self(self, which + 1, i, times, next);
    }
  };
  add(add, 0, 0, 0, Quad(1));
  return std::abs(static_cast<double>(sum - exact));
}
/// largest_defect() returns the largest defect of `kicks` kicks over all powers of the degree, to which each kick adds
/// one.
double largest_defect(const Alternation<Quad>& turns, std::size_t kicks, int degree) {
  double most = 0;
  std::vector<int> powers(kicks);
  const auto fill = [&](const auto& self, std::size_t i, int left) -> void {
    if (i + 1 == kicks) {
      powers[i] = left;
      most = std::max(most, defect(turns, powers));
      return;
    }
    for (int p = 0; p <= left; ++p) {
      powers[i] = p;
      self(self, i + 1, left - p);
    }
  };
  fill(fill, 0, degree - static_cast<int>(kicks));
  return most;
}

/// Claim has the orders in h of the errors that are linear, quadratic and cubic in ε; 0: not claimed.
struct Claim {
  Splitting splitting;
  std::array<int, 3> orders;
};
constexpr std::array<Claim, 4> claims{{{Splitting::saba_2, {4, 2, 0}},
                                       {Splitting::saba_4, {8, 2, 0}},
                                       {Splitting::aba_864, {8, 6, 4}},
                                       {Splitting::aba_1064, {10, 6, 4}}}};

TEST(Alternations, FulfilTheConditionsOfTheirOrders) {
  for (const Claim& claim : claims) {
    const std::size_t i = *alternation_of(claim.splitting);
    SCOPED_TRACE(alternations::named[i].name);
    const auto& turns = Alternation<Quad>::named(i);
    for (std::size_t kicks = 1; kicks <= 3; ++kicks) {
      const int order = claim.orders[kicks - 1];
      if (order == 0) continue;
      for (int degree = static_cast<int>(kicks); degree <= order; ++degree)
        EXPECT_LT(largest_defect(turns, kicks, degree), 1e-33) << kicks << " kicks, degree " << degree;
      EXPECT_GT(largest_defect(turns, kicks, order + 1), 1e-10) << kicks << " kicks";
    }
    const auto last = static_cast<std::size_t>(turns.stages);
    EXPECT_LT(std::abs(static_cast<double>(turns.middle[last - 1] + turns.drift[last] - 1)), 1e-33);
  }
}

/// error() returns the largest error in 100 revolutions of the spin–orbit problem with `steps` steps a revolution,
/// where force and damping are `strength` times their defaults.
double error(std::string_view setting, std::string_view choice, int steps, double strength) {
  Request request = runs::defaults("spin_orbit", "contact_splitting");
  runs::set(request, "step", 2 * pi / steps);
  runs::set(request, setting, choice);
  for (const char* weak : {"epsilon", "lambda"}) {
    const auto& parameters = runs::card(request).parameters;
    runs::set(request, weak, strength * parameters[runs::position(parameters, weak, &ParameterCard::name)].value);
  }
  request.end = 200 * pi;
  runs::only_final(request);
  runs::ask(request, "error");
  return runs::number(runs::go(request).outcome.diagnostics, "error/max");
}

// The error of saba_4 is ε h⁸ + ε² h², that of compositions, which do not use that ε is small, ε h² + ….
TEST(Alternations, FollowWeakForcesWithLongSteps) {
  const auto gain = [](std::string_view setting, std::string_view choice) {
    return error(setting, choice, 4, 1) / error(setting, choice, 4, 0.1);
  };
  EXPECT_NEAR(gain("splitting", "saba_4"), 100, 10);
  EXPECT_NEAR(gain("composition", "none"), 10, 1);
  const double coarse = error("splitting", "saba_4", 4, 1), fine = error("splitting", "saba_4", 8, 1);
  EXPECT_NEAR(coarse / fine, 4, 0.4);
  // These take seven and eight forces a step, kahan_li_6 nine.
  EXPECT_LT(error("splitting", "aba_864", 4, 1), 0.01 * error("composition", "kahan_li_6", 4, 1));
  EXPECT_LT(error("splitting", "aba_1064", 2, 1), 0.01 * error("composition", "kahan_li_6", 2, 1));
}

}  // namespace
