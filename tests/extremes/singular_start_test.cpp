// The Lane–Emden equation at its singular start t = 0, close to it, and where its motion ends.
#include <gtest/gtest.h>

#include <cmath>

#include "core/problems/lane_emden.hpp"
#include "core/schemes/alternation.hpp"
#include "tests/extremes/asking.hpp"

namespace {

using namespace least;
using namespace asking;

enum After : int { stop, go_on, with_sign, clamp };  // the choices of after_zero, in their order

Request star(std::string_view scheme, double n, After after = stop) {
  Request request = of("lane_emden", {scheme, {}}, {{"n", n}, {"after_zero", after}});
  runs::show_all(request);
  return request;
}
const ProblemCard& card() { return runs::problem_card("lane_emden"); }
template <class F>
void for_each_scheme(F&& f) {
  for (const std::size_t index : card().schemes) f(schemes()[index]);
}
/// for_each_composition() calls f for the request with every composition of its scheme and every splitting that has an
/// order of its own, or as it is.
template <class F>
void for_each_composition(const Request& request, F&& f) {
  for (const auto& parameter : scheme_of(request).parameters)
    if (parameter.name == "composition") {
      for (const auto& name : parameter.choices) f(choose(request, {{"composition", name}}));
      if (scheme_of(request).find("splitting"))
        for (const auto& named : alternations::named) f(choose(request, {{"splitting", named.name}}));
      return;
    }
  f(request);
}

bool first_order(const SchemeCard& scheme) { return !scheme.orders.empty() && scheme.orders.front().second == 1; }

TEST(AfterZero, StopEndsAtTheSurfaceAndSaysWhere) {
  struct Row {
    double n, zero;
  };
  for (const auto& [n, zero] : {Row{0, std::sqrt(6.0)}, Row{1, pi}, Row{3, 6.896848619376960}})
    for_each_scheme([&](const SchemeCard& scheme) {
      for_each_composition(star(scheme.id, n), [&](const Request& plain) {
        const Request request = ask(plain, {"zeros"});
        const auto result = go(request);
        const Termination& end = result.outcome.stop;
        const std::string what = std::string(scheme.id) + ' ' + std::to_string(n);
        ASSERT_EQ(end.reason, ReturnCode::left_domain) << what;
        ASSERT_TRUE(end.singular_at.has_value()) << what;
        const double tolerance = first_order(scheme)   ? 0.04
                                 : is_adaptive(scheme) ? 1e-6
                                 : scheme.own_clock    ? 3e-3  // longer steps where little moves
                                                       : 1e-3;
        EXPECT_NEAR(*end.singular_at, zero, tolerance) << what;
        EXPECT_LT(end.t, *end.singular_at) << what;
        if (!is_adaptive(scheme)) {
          EXPECT_LT(*end.singular_at - end.t, 0.01 * (1 + 1e-9)) << what << ": within the next step";
        }
        ASSERT_EQ(result.rows.size(), static_cast<std::size_t>(end.step) + 1) << what;
        EXPECT_GE(value(request, result.rows.back(), "q"), 0) << what;
        const auto& zeros = runs::list(result.outcome.diagnostics, "zeros");
        ASSERT_EQ(zeros.size(), 1U) << what;
        EXPECT_EQ(zeros[0], *end.singular_at) << what;
        // Asking for zeros does not change the run.
        EXPECT_EQ(go(plain).outcome.stop.singular_at, end.singular_at) << what;
      });
    });
  Request inside = star("contact_splitting", 1);
  inside.end = 3.1;
  EXPECT_EQ(reason(inside), ReturnCode::completed);
  EXPECT_EQ(reason(star("contact_splitting", 5)), ReturnCode::completed) << "no surface";
}

TEST(AfterZero, EveryChoiceEndsInAStatusForEveryIndex) {
  for_each_scheme([](const SchemeCard& scheme) {
    for (const double n : {0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.9, 20.0})
      for (const After after : {stop, go_on, with_sign, clamp}) {
        const ReturnCode why =
            go(everything(at(star(scheme.id, n, after), {{"t", 0.05}, {"q", 0.9}}), false)).outcome.stop.reason;
        const std::string what = std::string(scheme.id) + ' ' + std::to_string(n) + ' ' + std::to_string(after);
        const bool whole = n == std::floor(n), ends = n < 4;  // q reaches zero before t = 10
        if (after == clamp || after == with_sign || !ends || (after == go_on && whole)) {
          EXPECT_EQ(why, ReturnCode::completed) << what;
        } else if (after == stop) {
          EXPECT_EQ(why, ReturnCode::left_domain) << what;
        } else {
          EXPECT_TRUE(is_adaptive(scheme) ? why == ReturnCode::singular
                                          : why == ReturnCode::not_finite || why == ReturnCode::solver_failed)
              << what;
        }
      }
  });
}

// For n = 2 with the plain power q falls ever faster past its zero, to −∞ at t ≈ 12.431 (METHODS, section 1).
TEST(AfterZero, ThePlainSquareRunsToInfinity) {
  for (const std::string_view scheme : {"contact_splitting", "contact_leapfrog", "runge_kutta_4"}) {
    Request request = star(scheme, 2, go_on);
    request.end = 20;
    const auto result = go(request);
    EXPECT_NE(result.outcome.stop.reason, ReturnCode::completed) << scheme;
    EXPECT_NEAR(result.outcome.stop.t, 12.431, 0.05) << scheme;
    EXPECT_EQ(reason(set(request, {{"after_zero", with_sign}})), ReturnCode::completed) << scheme;
  }
}

// All rows lie within the star: the run ends at the surface, whatever is recorded.
TEST(AfterZero, NoSampleLiesBehindTheEnd) {
  for_each_scheme([](const SchemeCard& scheme) {
    Request request = star(scheme.id, 3);
    runs::only_final(request);
    const auto bare = go(request);
    EXPECT_NEAR(bare.outcome.t, *bare.outcome.stop.singular_at, 1e-12) << scheme.id;
    EXPECT_GE(bare.outcome.final[0], 0) << scheme.id;
    EXPECT_NEAR(bare.outcome.final[0], 0, 1e-12) << scheme.id;
    for (const auto mode : {Record::Mode::samples, Record::Mode::curve}) {
      request.record = {mode, 41, {}};
      const auto result = go(request);
      EXPECT_GT(result.rows.back()[0], 6) << scheme.id;
      EXPECT_LE(result.rows.back()[0], result.outcome.stop.t) << scheme.id;
      EXPECT_EQ(result.outcome.stop.t, bare.outcome.stop.t) << scheme.id;
      EXPECT_EQ(result.outcome.final, bare.outcome.final) << scheme.id;
    }
  });
}

TEST(AfterZero, IsReachedWithinTheLastShorterStepToo) {
  Request request = ask(star("contact_splitting", 1), {"zeros"});
  request.end = 3.1419;  // the surface lies between the last grid point, 3.14, and the end
  const auto result = go(request);
  EXPECT_EQ(result.outcome.stop.reason, ReturnCode::left_domain);
  EXPECT_NEAR(result.outcome.stop.singular_at.value_or(0), pi, 1e-4);
  EXPECT_EQ(result.outcome.stop.step, 314);
  EXPECT_NEAR(result.outcome.t, pi, 1e-4);
}

// One step over the whole span, which is outside the star where samples lie and inside at its end. Without care such a
// step is taken, undone and taken again for ever, past every budget.
TEST(AfterZero, IsFoundOnTheWayOfAStepThatEndsInside) {
  for (const std::string_view composition : {"kahan_li_6", "kahan_li_8", "sofroniou_spaletta_10"}) {
    Request request = set(choose(star("contact_splitting", 3), {{"composition", composition}}), {{"step", 10}});
    std::vector<double> times;
    for (int k = 1; k <= 64; ++k) times.push_back(6.9 * k / 64);
    runs::at_times(request, times);
    request.limits.seconds = 2;
    const auto result = go(request);
    EXPECT_EQ(result.outcome.stop.reason, ReturnCode::left_domain) << composition;
    EXPECT_GT(result.outcome.stop.singular_at.value_or(0), result.rows.back()[0]) << composition;
  }
}

TEST(SingularStart, OfEverySchemeFollowsTheRegularSolution) {
  for_each_scheme([](const SchemeCard& scheme) {
    for_each_composition(star(scheme.id, 5), [&](const Request& plain) {
      for (const double h : {1e-3, 0.01, 0.07, 0.1, 0.25}) {
        Request request = plain;
        request.settings[0] = is_adaptive(scheme) ? 1e-3 * std::pow(h, 4) : h;
        request.end = 1;
        const auto result = go(request);
        const std::string what = std::string(scheme.id) + ' ' + std::to_string(h);
        // A stage backward in time may meet, or jump over, the pole of the variational schemes.
        const bool variational = scheme.id == "contact_leapfrog" || scheme.id == "contact_variational_midpoint";
        if (h > 0.05 && variational && request.settings[1] > 0) continue;
        if (h > 0.05 && scheme.own_clock && !is_adaptive(scheme) &&
            result.outcome.stop.reason == ReturnCode::singular) {  // its clock and the damping 2/t disagree
          EXPECT_NE(result.outcome.stop.detail.text().find("shorter"), std::string::npos) << what;
          continue;
        }
        ASSERT_EQ(result.outcome.stop.reason, ReturnCode::completed) << what;
        const double square = scheme.id == "contact_splitting"           ? 1.5
                              : scheme.own_clock && !is_adaptive(scheme) ? 1.8
                              : scheme.id == "contact_leapfrog"          ? 0.06
                                                                         : 0.3;
        const double slack = is_adaptive(scheme)   ? 10 * request.settings[0]
                             : first_order(scheme) ? 0.3 * h
                                                   : square * h * h + 1e-12;
        double most = 0;
        for (const auto& row : result.rows)
          most = std::max(most, std::abs(row[1] - 1 / std::sqrt(1 + row[0] * row[0] / 3)));
        EXPECT_LT(most, slack) << what;
        EXPECT_GT(std::abs(result.outcome.final[2]), 0.01) << what << ": s is carried from the start on";
      }
    });
  });
}

// Splittings through t = 0 would be of order 2, and have larger errors.
TEST(SingularStart, LeavesSplittingsOfHighOrderTheirOrder) {
  for (const char* splitting : {"aba_864", "aba_1064"}) {
    Request request = choose(star("contact_splitting", 5), {{"splitting", splitting}});
    request.settings[0] = 0.05;
    request.end = 2;
    const auto result = go(request);
    ASSERT_EQ(result.outcome.stop.reason, ReturnCode::completed) << splitting;
    EXPECT_NEAR(result.outcome.final[0], 1 / std::sqrt(1 + 4.0 / 3), 1e-7) << splitting;
  }
}

// The series ends where all further terms vanish, not where a single one happens to, as the third does for n = 5/8.
TEST(SingularStart, SeriesOfALoneStateHasAllItsDigits) {
  for (const double n : {0.0, 0.625, 1.0, 1.5, 3.0, 5.0, 20.0})
    for (const double t : {1e-3, 0.05, 0.1}) {
      problems::LaneEmden<double> star;
      problems::LaneEmden<Quad> wide;
      star.n = n;
      wide.n = Quad(n);
      const auto x = star.series<double, true>(t);
      const auto y = wide.series<Quad, true>(Quad(t));
      for (std::size_t i = 0; i < x.size; ++i) {
        const auto expected = static_cast<double>(y[i]);
        EXPECT_NEAR(x[i], expected, 4 * std::numeric_limits<double>::epsilon() * std::abs(expected))
            << n << ' ' << t << ' ' << i;
      }
    }
}

TEST(SingularStart, FromAnotherCentreIsRunOrRefused) {
  for_each_scheme([](const SchemeCard& scheme) {
    for (const double q : {0.0, 0.5, 2.0, 1e10})
      for (const double p : {0.0, 0.5})
        for_each_composition(at(star(scheme.id, 3, with_sign), {{"q", q}, {"p", p}}), [&](const Request& request) {
          const auto result = go(steps(request, 300));
          const std::string what = std::string(scheme.id) + ' ' + std::to_string(q) + ' ' + std::to_string(p);
          if (result.outcome.stop.reason == ReturnCode::singular) {
            EXPECT_EQ(result.outcome.stop.step, 0) << what;
            EXPECT_EQ(result.outcome.stop.singular_at, 0.0) << what;
            EXPECT_TRUE(result.rows.empty()) << what;
          } else if (p == 0 && q < 10) {
            // q(t; q₀) = q₀ q(q₀ t; 1) for n = 3
            EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed) << what;
            Request regular = set(star("contact_splitting", 3, with_sign), {{"step", 1e-3}});
            regular.end = q * result.outcome.t;
            const double expected = q > 0 ? q * go(regular).outcome.final[0] : 0;
            EXPECT_NEAR(result.outcome.final[0], expected, 5e-3 * q) << what;
          }
        });
  });
  EXPECT_EQ(reason(at(star("contact_leapfrog", 3), {{"q", 2}})), ReturnCode::left_domain) << "runs to its surface";
  EXPECT_EQ(reason(at(star("runge_kutta_4", 3), {{"q", 2}})), ReturnCode::singular);
}

TEST(SingularStart, CloseToItEverySchemeEndsInAStatus) {
  for_each_scheme([](const SchemeCard& scheme) {
    for (const double t : {5e-324, 1e-300, 1e-8, 1e-3, 0.05, 0.1}) {
      const auto start = runs::regular_start(star(scheme.id, 3), t);
      ASSERT_TRUE(start.has_value()) << t;
      EXPECT_NEAR((*start)[0], 1 - t * t / 6, 1e-5) << t;
      for_each_composition(star(scheme.id, 3), [&](Request request) {
        runs::scene(request).start = t;
        runs::scene(request).initial = *start;
        const auto result = go(everything(steps(request, 200), false));
        if (is_adaptive(scheme)) {
          if (t < 1e-300) return;  // 2/t is infinite, and so is the energy asked for
          EXPECT_EQ(result.outcome.stop.reason, ReturnCode::left_domain) << scheme.id << ' ' << t;
          EXPECT_NEAR(result.outcome.stop.singular_at.value_or(0), 6.896848619376960, 1e-6) << scheme.id << ' ' << t;
        } else if (t >= 0.05 && scheme.id != "explicit_euler") {
          EXPECT_EQ(result.outcome.stop.reason, ReturnCode::completed) << scheme.id << ' ' << t;
        }
      });
    }
    EXPECT_FALSE(runs::regular_start(star(scheme.id, 3), 7).has_value()) << "beyond the surface";
    EXPECT_FALSE(runs::regular_start(star(scheme.id, 3), -0.05).has_value());
  });
  Request close = star("runge_kutta_4", 3);
  runs::scene(close).start = 0.05;
  runs::scene(close).initial = *runs::regular_start(close, 0.05);
  EXPECT_NEAR(go(close).outcome.stop.singular_at.value_or(0), 6.896848619376960, 1e-8);
}

}  // namespace
