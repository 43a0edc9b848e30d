// Explicit contact schemes for damped scenes of many coordinates: Toda's lattice closed to a ring, with friction that
// is constant or changes in time.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/from_values.hpp"
#include "core/run/backend.hpp"
#include "core/run/discrete_energy.hpp"
#include "core/schemes/contact_leapfrog.hpp"
#include "core/schemes/contact_splitting.hpp"
#include "core/schemes/contact_symplectic_euler.hpp"
#include "tests/support/rings.hpp"

namespace sized_damped {
namespace {

using namespace rings;
constexpr Friction damped[] = {Friction::constant, Friction::timed};

struct Choice {
  const char *scheme, *setting = "", *value = "";
  int order = 2;
  double step = 0.1;
};
constexpr Choice choices[] = {{"contact_symplectic_euler", "", "", 1, 0.02},
                              {"contact_splitting", "splitting", "automatic"},
                              {"contact_splitting", "splitting", "plain"},
                              {"contact_splitting", "splitting", "merged"},
                              {"contact_splitting", "composition", "suzuki_4", 4, 0.2},
                              {"contact_splitting", "composition", "kahan_li_6", 6, 0.4},
                              {"contact_splitting", "splitting", "saba_2"},
                              {"contact_splitting", "splitting", "saba_4"},
                              {"contact_splitting", "splitting", "aba_864", 4, 0.4},
                              {"contact_splitting", "splitting", "aba_1064", 4, 0.4}};
Request chosen(const Choice& choice, const std::shared_ptr<const Mechanics>& mechanics, const std::vector<double>& from,
               double end, double step) {
  Request request = stepped(choice.scheme, mechanics, from, end, step);
  if (*choice.setting) runs::set(request, choice.setting, choice.value);
  runs::show_all(request);  // with s
  return request;
}

TEST(SizedDamped, SchemesHaveTheirOrders) {
  for (const int n : {9, 100})
    for (const Friction friction : damped) {
      const auto mechanics = ring(n, friction);
      const auto from = start(n, friction);
      Request exact = request_by("taylor", mechanics, from, 4);
      runs::show_all(exact);
      const auto truth = final_of(exact);
      for (const Choice& choice : choices) {
        const auto error = [&](double step) {
          return distance(final_of(chosen(choice, mechanics, from, 4, step)), truth);
        };
        const double coarse = error(choice.step), fine = error(choice.step / 2);
        EXPECT_NEAR(std::log2(coarse / fine), choice.order, 0.35) << choice.scheme << choice.value << n;
        EXPECT_GT(fine, 1e-12) << choice.scheme << choice.value << " is at round-off";
      }
    }
}

/// by_compiled() makes `steps` steps of a scheme on the compiled problem and returns the card's variables.
template <class P, class Scheme>
std::vector<double> by_compiled(const P& problem, const Scheme& scheme, const std::vector<double>& from, int steps) {
  auto x = state_of<FullStateOf<P>>(from);
  auto stepper = scheme.bind(problem, x);
  for (int k = 0; k < steps; ++k) {
    EXPECT_EQ(stepper.step(x, scheme.step), StepStatus::ok);
    x.t = (k + 1) * scheme.step;
  }
  std::vector<double> end;
  for (std::size_t i = 0; i < from.size(); ++i) end.push_back(x[i]);
  return end;
}
template <int N, Friction friction, bool Coupled = false>
void is_as_compiled() {
  const Ring<N, friction, Coupled> problem;
  const auto mechanics = ring(N, friction, {.coupled = Coupled});
  const auto from = start(N, friction);
  constexpr int steps = 40;
  for (const Choice& choice : choices) {
    Request request = chosen(choice, mechanics, from, steps * choice.step, choice.step);
    const auto found = final_of(request);
    const std::string what = std::string(choice.scheme) + choice.value + " " + std::to_string(N);
    const auto& settings = request.settings;
    if (std::string_view(choice.scheme) == "contact_splitting") {
      const auto scheme = from_values<ContactSplitting>(ContactSplitting::fields, settings);
      EXPECT_LT(distance(found, by_compiled(problem, scheme, from, steps)), 1e-12) << what;
      continue;
    }
    const auto scheme = from_values<ContactSymplecticEuler>(ContactSymplecticEuler::fields, settings);
    EXPECT_LT(distance(found, by_compiled(problem, scheme, from, steps)), 1e-12) << what;
    request.record = {Record::Mode::every, 1, {}};
    const auto name_of = [](const auto& column) { return column.name; };
    request.columns = {runs::position(runs::card(request).columns, "discrete_energy", name_of)};
    const auto x = state_of<FullStateOf<Ring<N, friction, Coupled>>>(from);
    EXPECT_NEAR(runs::go(request).rows[1][0], discrete_energy(scheme, problem, x, scheme.step), 1e-12) << what;
  }
}
TEST(SizedDamped, StatesAreThoseOfTheProblemThatIsCompiled) {
  is_as_compiled<1, Friction::constant>();
  is_as_compiled<1, Friction::timed>();
  is_as_compiled<2, Friction::constant>();
  is_as_compiled<2, Friction::timed, true>();
  is_as_compiled<3, Friction::timed>();
  is_as_compiled<8, Friction::constant>();
  is_as_compiled<9, Friction::timed>();
  is_as_compiled<9, Friction::constant, true>();
}

// Backward in time friction accelerates: with the signs of α, p and s reversed a run returns.
TEST(SizedDamped, SymmetricOnesLeadBack) {
  constexpr int n = 30;
  for (const Choice& choice : choices) {
    if (choice.order == 1) continue;
    auto x = final_of(chosen(choice, ring(n, Friction::constant), start(n, Friction::constant), 4, 0.1));
    EXPECT_GT(distance(x, start(n, Friction::constant)), 0.1);
    const auto turn = [&] {
      for (std::size_t i = n; i < x.size(); ++i) x[i] = -x[i];
    };
    turn();
    x = final_of(chosen(choice, ring(n, Friction::constant, {.damping = -alpha}), x, 4, 0.1));
    turn();
    EXPECT_LT(distance(x, start(n, Friction::constant)), 1e-11) << choice.scheme << choice.value;
  }
}

TEST(SizedDamped, TheContactFormIsKept) {
  for (const int n : {9, 100})
    for (const Choice& choice : choices) {
      Request request = chosen(choice, ring(n, Friction::constant), start(n, Friction::constant), 0.3, 0.1);
      runs::ask(request, "structure");
      runs::ask(request, "volume");
      const auto found = runs::go(request).outcome.diagnostics;
      EXPECT_LT(runs::number(found, "structure/max_defect"), 1e-13) << choice.scheme << choice.value << n;
      const double factor = choice.order == 1 ? 1 - 0.1 * alpha : std::exp(-0.1 * alpha);
      EXPECT_NEAR(runs::number(found, "structure/factor"), factor, 1e-14) << choice.scheme << choice.value << n;
      EXPECT_LT(runs::number(found, "volume/max_defect"), 1e-12) << choice.scheme << choice.value << n;
    }
}

// Without the springs Σp decays by e^(−∫α); for constant α a splitting has that to round-off.
TEST(SizedDamped, TheMomentumOfTheWholeDecays) {
  constexpr int n = 64;
  const auto whole = [](const std::vector<double>& x) {
    double sum = 0;
    for (std::size_t i = n; i < 2 * n; ++i) sum += x[i];
    return sum;
  };
  const double before = whole(start(n, Friction::constant));
  for (const Choice& choice : choices) {
    const double after =
        whole(final_of(chosen(choice, ring(n, Friction::constant, {.held = 0}), start(n, Friction::constant), 5, 0.1)));
    const double factor = choice.order == 1 ? std::pow(1 - 0.1 * alpha, 50) : std::exp(-5 * alpha);
    EXPECT_NEAR(after / before, factor, 1e-12) << choice.scheme << choice.value;
  }
}

// Derivatives of a step against differences of runs of one step.
TEST(SizedDamped, TangentsAreTheChangesOfAStep) {
  constexpr int n = 9;
  constexpr double aside = 1e-3;
  for (const Friction friction : damped)
    for (const Choice& choice : choices) {
      const auto mechanics = ring(n, friction);
      const Request request = chosen(choice, mechanics, start(n, Friction::constant), 0.2, 0.2);
      const auto backend = mechanics->backend(request);
      const RunState x = backend->table().start(start(n, Friction::constant), 0);
      TangentMap map;
      ASSERT_TRUE(backend->tangents(request).plain(
          x, [] { return true; }, map));
      double most = 0;
      for (std::size_t j = 0; j < map.size(); ++j) {
        std::vector<double> column(map.size(), 0);
        for (const auto& [far, weight] : {std::pair{1, 8.0}, std::pair{2, -1.0}})
          for (const int side : {-1, 1}) {
            auto from = start(n, Friction::constant);
            from[j] += side * far * aside;
            const auto end = final_of(chosen(choice, mechanics, from, 0.2, 0.2));
            for (std::size_t i = 0; i < map.size(); ++i) column[i] += side * weight * end[i] / (12 * aside);
          }
        for (std::size_t i = 0; i < map.size(); ++i) most = std::max(most, std::abs(column[i] - map.slope(i, j)));
      }
      EXPECT_LT(most, 1e-10) << choice.scheme << choice.value;
    }
}

TEST(SizedDamped, StrongDampingIsSaid) {
  const auto warned = [](const Choice& choice, double step, const char* code) {
    const auto outcome = runs::go(chosen(choice, ring(9, Friction::constant, {.damping = 4}),
                                         start(9, Friction::constant), 4 * step, step))
                             .outcome;
    return std::ranges::count(outcome.warnings, code, &Warning::code) == 1;
  };
  const Choice euler{"contact_symplectic_euler"}, plain{"contact_splitting", "splitting", "plain"},
      merged{"contact_splitting", "splitting", "merged"}, chooses{"contact_splitting"};
  EXPECT_TRUE(warned(euler, 0.26, "damping_sign"));
  EXPECT_FALSE(warned(euler, 0.24, "damping_sign"));
  EXPECT_TRUE(warned(plain, 0.51, "stiff_step"));
  EXPECT_FALSE(warned(plain, 0.49, "stiff_step"));
  EXPECT_FALSE(warned(merged, 0.51, "stiff_step"));
  EXPECT_FALSE(warned(chooses, 0.51, "stiff_step"));
}

/// Where a force has no series, such as |x|^1.5 at x = 0, the truth is a run in quad precision of the variables that
/// the motion needs. s is not one of them, whether the run carries it or not.
TEST(SizedDamped, ErrorsAreThoseOfTheMotionWhereAForceHasNoSeries) {
  const auto scene =
      texts::mechanics_of(texts::damped(of(Definition::Kind::potential, {"x"}, {{"a", 0.23}}, "abs(x)^1.5"), "a"));
  const auto error = [&](double step, bool with_action) {
    Request request = stepped("contact_leapfrog", scene, {0.6, 0.96}, 3, step);
    if (with_action) runs::show_all(request);
    runs::ask(request, "error");
    const auto outcome = runs::go(request).outcome;
    return std::pair(runs::number(outcome.diagnostics, "error/final"), runs::number(outcome.diagnostics, "error/max"));
  };
  const auto [final_coarse, coarse] = error(0.01, false);
  const auto [final_fine, fine] = error(0.005, false);
  EXPECT_LE(final_coarse, coarse);
  EXPECT_NEAR(std::log2(coarse / fine), 1.5, 0.3);  // without a series the order 2 drops by a half
  EXPECT_LT(coarse, 1e-3);
  EXPECT_EQ(error(0.01, true), std::pair(final_coarse, coarse));
}

TEST(SizedDamped, TheyAreOfferedWhereThereIsDamping) {
  text::TypedScene typed;
  typed.scene = of(Definition::Kind::potential, {"q[100]"}, {}, "sum(i=1..100, q[i]^4)");
  for (const char* scheme : {"contact_splitting", "contact_symplectic_euler"}) {
    const auto fits = [&](const ProblemCard& card) { return runs::fits(card, find_scheme(scheme).value()); };
    EXPECT_TRUE(fits(ring(100, Friction::timed)->card())) << scheme;
    EXPECT_FALSE(fits(made(typed)->card())) << scheme;
  }
}

/// q̈ = −q − q̇/10 does not depend on a constant in V, although with it s = −10 V (1 − e^{−t/10}) soon exceeds 1e75.
TEST(CarriedAction, HasNoSayInTheMotion) {
  constexpr auto V = Definition::Kind::potential;
  for (const int n : {1, 12}) {
    text::TypedScene typed;
    typed.scene = texts::damped(of(V, {"q[n]"}, {{"n", double(n)}}, "sum(i=1..n, q[i]^2/2) + 1e76"), "0.1");
    const auto mechanics = made(typed);
    for (const std::size_t index : mechanics->card().schemes) {
      const std::string& scheme = schemes()[index].id;
      Request request = request_by(scheme, mechanics, std::vector<double>(std::size_t(n), 0.5), 3);
      request.limits.steps = 100'000;
      const auto alone = runs::go(request).outcome;
      runs::show_all(request);
      const auto beside = runs::go(request).outcome;
      const std::size_t s = alone.final.size() - 1;
      ASSERT_EQ(beside.stop.reason, alone.stop.reason) << scheme << ' ' << n << ' ' << beside.stop.detail;
      EXPECT_EQ(std::vector(beside.final.begin(), beside.final.end() - 1),
                std::vector(alone.final.begin(), alone.final.end() - 1))
          << scheme << ' ' << n;
      if (alone.stop.reason == ReturnCode::completed) {
        EXPECT_LT(beside.final[s], -1e76) << scheme << ' ' << n;
      }
    }
  }
}

}  // namespace
}  // namespace sized_damped
