// sensitive_end of random scenes as text: there is none for integrable motions, which are never chaotic, and one for
// coupled ones.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/support/texts.hpp"

namespace {

using namespace texts;

bool sensitive(const std::string& potential, const std::vector<double>& start, const char* scheme, double end) {
  Request request = typed_as(runs::defaults("henon_heiles", scheme),
                             mechanics_of(of(Definition::Kind::potential, {"x", "y"}, {}, potential)));
  std::copy(start.begin(), start.end(), runs::scene(request).initial.begin());
  request.end = end;
  request.record.count = 0;
  request.control = true;
  const auto outcome = runs::go(request).outcome;
  return std::ranges::any_of(outcome.warnings, [](const Warning& warning) { return warning.code == "sensitive_end"; });
}

TEST(SensitiveEndOfText, IsNotSaidOfIntegrableMotionAndIsOfChaos) {
  std::mt19937_64 random(5);
  const auto any = [&](double from, double to) { return std::uniform_real_distribution<double>(from, to)(random); };
  const char* schemes[] = {"leapfrog", "taylor", "dormand_prince_5", "fehlberg_78", "runge_kutta_4"};
  for (int n = 0; n < 40; ++n) {
    const double a = any(0.3, 2), b = any(0.3, 2), c = any(0.3, 2), d = any(0.3, 2);
    const std::string potentials[] = {
        fmt::format("{}*x^2/2 + {}*y^2/2 + {}*x^4/4 + {}*y^4/4", a, b, c, d),
        fmt::format("-{}*cos(x) - {}*cos(y)", a, b),
        fmt::format("-{}/sqrt(x^2 + y^2) + {}/(x^2 + y^2)", a, 0.01 * b),
        fmt::format("{}*(x^2 + y^2)/2 + {}*(x^2 + y^2)^2/4", a, b),
    };
    const std::vector<double> start = {any(0.5, 1.5), any(-1, 1), any(-0.5, 0.5), any(0.2, 0.8)};
    EXPECT_FALSE(sensitive(potentials[n % 4], start, schemes[n % 5], n % 3 == 0 ? 3000 : 500)) << potentials[n % 4];
  }
  for (int n = 0; n < 10; ++n)  // x²y² with little to keep it from chaos
    EXPECT_TRUE(sensitive("x^2*y^2/2 + 0.005*(x^4 + y^4)", {any(0.5, 1.5), any(0.5, 1), any(-0.5, 0.5), any(0.2, 0.8)},
                          schemes[n % 5], 1000));
}

}  // namespace
