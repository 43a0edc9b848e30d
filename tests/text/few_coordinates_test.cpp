// Scenes of few coordinates, for which steps have special code, against the same scenes among many coordinates at rest.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/texts.hpp"

namespace few_coordinates {
namespace {

using namespace texts;

/// scene() has a potential of the first n of the coordinates a, b, c, d and a kinetic energy with a diagonal metric or
/// a full one; with `resting`, also coordinates z1 … z9 that rest at 0.
Definition scene(std::size_t n, bool full, bool resting, const std::string& more = "") {
  const std::vector<std::string> names{"a", "b", "c", "d"};
  std::vector<std::string> variables(names.begin(), names.begin() + std::ptrdiff_t(n));
  std::string h = "a^2/2 + a^4/8 - a/5";
  for (std::size_t i = 0; i < n; ++i) {
    h += " + p" + names[i] + "^2/" + std::to_string(2 + i);
    if (i == 0) continue;
    h += " + (" + names[i] + " - " + names[i - 1] + ")^2/2 + cos(" + names[i] + " + a)";
    if (full) h += " + p" + names[i] + "*p" + names[i - 1] + "/7";
  }
  for (int k = 1; resting && k < 10; ++k) {
    variables.push_back("z" + std::to_string(k));
    h += " + pz" + std::to_string(k) + "^2/2 + z" + std::to_string(k) + "^2/2";
  }
  return of(Definition::Kind::hamiltonian, variables, {}, h + more);
}

/// start() is the start of the first n coordinates; those at rest follow them.
std::vector<double> start(std::size_t n, bool resting) {
  constexpr double q[] = {0.5, -0.2, 0.3, 0.1}, p[] = {0.3, 0.1, -0.4, 0.2};
  const std::size_t all = n + (resting ? 9 : 0);
  std::vector<double> x(2 * all);
  for (std::size_t i = 0; i < n; ++i) {
    x[i] = q[i];
    x[all + i] = p[i];
  }
  return x;
}

struct Choice {
  const char *scheme, *setting = nullptr, *value = nullptr;
  double number = 0;  ///< the setting's value where `value` is nullptr
};

Solution outcome(const Definition& definition, const Choice& choice, const std::vector<double>& from, double end,
                 double step = 0) {
  Request request = request_by(choice.scheme, mechanics_of(definition), from, end);
  if (choice.value) runs::set(request, choice.setting, std::string_view(choice.value));
  if (choice.setting && !choice.value) runs::set(request, choice.setting, choice.number);
  if (step > 0) runs::set(request, "step", step);
  return runs::go(request).outcome;
}

void expect_same(std::size_t n, bool full, const Choice& choice, const std::string& more = "") {
  const Solution few = outcome(scene(n, full, false, more), choice, start(n, false), 4),
                 many = outcome(scene(n, full, true, more), choice, start(n, true), 4);
  ASSERT_EQ(few.stop.reason, ReturnCode::completed) << choice.scheme << few.stop.detail.text();
  EXPECT_EQ(few.cost.steps, many.cost.steps) << choice.scheme;
  for (std::size_t i = 0; i < n; ++i) {
    EXPECT_NEAR(few.final[i], many.final[i], 1e-11) << choice.scheme << n << full;
    EXPECT_NEAR(few.final[n + i], many.final[n + 9 + i], 1e-11) << choice.scheme << n << full;
  }
}

TEST(FewCoordinates, MoveAsAmongManyThatRest) {
  const Choice choices[] = {{"variational_midpoint"},
                            {"variational_midpoint", "composition", "kahan_li_6"},
                            {"galerkin_4"},
                            {"energy_momentum"},
                            {"adaptive_verlet", "monitor", "arclength"},
                            {"time_transformed"},
                            {"time_transformed", "composition", "kahan_li_6"}};
  for (std::size_t n = 1; n <= 4; ++n)
    for (const bool full : {false, true})
      if (n > 1 || !full)
        for (const Choice& choice : choices) expect_same(n, full, choice);
}

TEST(FewCoordinates, MoveAsAmongManyThatRestWhereTheyAreDamped) {
  const Choice choices[] = {{"contact_variational_midpoint"},
                            {"contact_galerkin_4"},
                            {"contact_gauss"},
                            {"contact_gauss", "stages", nullptr, 3},
                            {"time_transformed"}};
  for (std::size_t n = 1; n <= 4; ++n)
    for (const char* damping : {" + s/9", " + (2 + sin(t))/20*s"})
      for (const Choice& choice : choices) expect_same(n, n == 3, choice, damping);
}

// p₁ − p₀ = −h ∇V((q₀ + q₁)/2) to the last digits, however long the step.
TEST(FewCoordinates, SolveTheirEquationsToRounding) {
  const auto scene = of(Definition::Kind::hamiltonian, {"x"}, {}, "px^2/2 + x^2/2 + x^4");
  for (const double h : {0.01, 0.03, 0.05, 0.07, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5})
    for (const double q : {0.5, 0.7, 0.9}) {
      const auto x = outcome(scene, {"variational_midpoint"}, {q, 0.3}, h, h).final;
      const double middle = (q + x[0]) / 2;
      EXPECT_NEAR(x[1], 0.3 - h * (middle + 4 * middle * middle * middle), 2e-15) << h << " " << q;
    }
}

// V″ has no entries: there is nothing to solve, and every one of these schemes is exact.
TEST(FewCoordinates, FallInAUniformField) {
  for (const std::size_t n : {1, 2, 9}) {
    std::vector<std::string> variables;
    std::string h;
    std::vector<double> from(2 * n, 0.5);
    for (std::size_t i = 1; i <= n; ++i) {
      variables.push_back("x" + std::to_string(i));
      h += (i > 1 ? " + px" : "px") + std::to_string(i) + "^2/2 + 0.3*x" + std::to_string(i);
    }
    for (const char* scheme : {"variational_midpoint", "galerkin_4", "energy_momentum"}) {
      const auto x = outcome(of(Definition::Kind::hamiltonian, variables, {}, h), {scheme}, from, 2, 0.125).final;
      EXPECT_NEAR(x[0], 0.5 + 0.5 * 2 - 0.15 * 4, 1e-12) << scheme << n;
      EXPECT_NEAR(x[n], 0.5 - 0.3 * 2, 1e-12) << scheme << n;
    }
  }
}

// M + β V″ has no inverse, the density of steps is lost, or the energy does not suffice: the reason is the same as for
// many coordinates.
TEST(FewCoordinates, SayWhyTheyStopAsManyDo) {
  struct Stop {
    Choice choice;
    const char *hamiltonian, *rest;
    double step;
    ReturnCode reason;
  };
  const Stop stops[] = {
      {{"variational_midpoint"}, "px^2/2 - x^2/2", "", 2, ReturnCode::solver_failed},
      {{"variational_midpoint"}, "px^2/2 + sqrt(x - 0.49)", "", 0.5, ReturnCode::solver_failed},
      {{"adaptive_verlet", "monitor", "arclength"}, "px^2/2 + 50*x^4", "", 0.7, ReturnCode::singular},
      {{"time_transformed", "kappa", nullptr, -0.13}, "px^2/2 + x^2/2", "", 0, ReturnCode::singular},
  };
  for (const Stop& stop : stops) {
    std::vector<std::string> many{"x"};
    std::string h = stop.hamiltonian;
    std::vector<double> from(20);
    for (int k = 1; k < 10; ++k) {
      many.push_back("z" + std::to_string(k));
      h += " + pz" + std::to_string(k) + "^2/2 + z" + std::to_string(k) + "^2/2";
    }
    from[0] = 0.5;
    from[10] = 0.2;
    const auto a = outcome(of(Definition::Kind::hamiltonian, {"x"}, {}, stop.hamiltonian), stop.choice, {0.5, 0.2}, 20,
                           stop.step),
               b = outcome(of(Definition::Kind::hamiltonian, many, {}, h), stop.choice, from, 20, stop.step);
    EXPECT_EQ(a.stop.reason, stop.reason) << stop.hamiltonian << a.stop.detail.text();
    EXPECT_EQ(b.stop.reason, stop.reason) << stop.hamiltonian << b.stop.detail.text();
    EXPECT_EQ(a.stop.detail.text(), b.stop.detail.text());
    EXPECT_EQ(a.cost.steps, b.cost.steps);
  }
}

}  // namespace
}  // namespace few_coordinates
