// Work–precision studies: what accuracy costs.
#include <cmath>
#include <map>

#include "tests/study/studies.hpp"

namespace {

using namespace studies;

StudyPlan plan(std::string_view problem, const std::vector<std::pair<std::string_view, std::string_view>>& schemes,
               double end = 0) {
  StudyPlan p;
  p.scene = scene(problem, end);
  for (const auto& [id, composition] : schemes) p.schemes.push_back(choice(p.scene, id, composition));
  p.budget_seconds = 60;
  p.most_forces = 300'000;
  return p;
}

TEST(WorkPrecision, FindsTheDeclaredOrders) {
  const auto check = [](const StudyPlan& p) {
    const Study study = work_precision(p, watch, never);
    for (const StudyCurve& curve : study.curves) {
      SCOPED_TRACE(std::string(p.scene.scene->card().id) + " " + name(curve.scheme) + " " + curve.why);
      EXPECT_GT(curve.expected_order, 0);
      EXPECT_NEAR(curve.observed_order, curve.expected_order, curve.expected_order > 6 ? 0.5 : 0.25);
    }
    return study;
  };
  const Study pendulum = check(plan("pendulum",
                                    {{"explicit_euler", ""},
                                     {"explicit_midpoint", ""},
                                     {"runge_kutta_4", ""},
                                     {"ruth_3", ""},
                                     {"symplectic_euler", ""},
                                     {"leapfrog", "none"},
                                     {"leapfrog", "suzuki_4"},
                                     {"leapfrog", "kahan_li_6"},
                                     {"leapfrog", "kahan_li_8"},
                                     {"variational_midpoint", "none"},
                                     {"galerkin_4", "none"},
                                     {"galerkin_4", "kahan_li_6"},
                                     {"time_transformed", "none"},
                                     {"time_transformed", "kahan_li_6"}},
                                    10));
  EXPECT_EQ(pendulum.how, "closed form");
  EXPECT_EQ(pendulum.curves[0].setting, "step");
  EXPECT_EQ(pendulum.curves[12].setting, "sigma");
  check(plan("damped_oscillator",
             {{"contact_leapfrog", "none"},
              {"contact_leapfrog", "kahan_li_6"},
              {"contact_splitting", "kahan_li_8"},
              {"contact_variational_midpoint", "none"},
              {"contact_galerkin_4", ""},
              {"contact_gauss", ""}},
             10));
  // Adaptive steps, with constant damping, with damping that changes in time, and on an eccentric orbit.
  for (const auto& [problem, end] :
       {std::pair("damped_oscillator", 10), std::pair("perturbed_kepler", 10), std::pair("damped_kepler", 7)}) {
    const Study timed = check(plan(
        problem, {{"time_transformed", "none"}, {"time_transformed", "suzuki_4"}, {"time_transformed", "kahan_li_6"}},
        end));
    for (const StudyCurve& curve : timed.curves) {
      EXPECT_EQ(curve.setting, "sigma");
      EXPECT_TRUE(std::ranges::all_of(curve.points, [](const StudyPoint& p) { return std::isnan(p.step); }));
    }
  }
  EXPECT_EQ(check(plan("van_der_pol", {{"contact_splitting", "none"}, {"runge_kutta_4", ""}}, 5)).how,
            "quad precision run");
  StudyPlan all_along = plan("henon_heiles", {{"leapfrog", "none"}, {"leapfrog", "kahan_li_6"}}, 10);
  all_along.at_end = false;
  check(all_along);
}

/// numbers() returns everything in a study that must not depend on the machine.
std::vector<double> numbers(const Study& study) {
  std::vector<double> all{study.uncertainty, study.floor, study.growth, study.end};
  for (const StudyCurve& curve : study.curves) {
    all.push_back(std::isnan(curve.observed_order) ? 0 : curve.observed_order);
    for (const StudyPoint& p : curve.points)
      for (const double x : {p.value, p.step, p.error, double(p.force_evaluations), double(p.status)})
        all.push_back(std::isnan(x) ? -1 : x);
  }
  for (const ParetoPoint& p : study.pareto)
    if (p.fewest_forces) all.insert(all.end(), {double(p.curve), double(p.point)});
  return all;
}

TEST(WorkPrecision, RepeatsItselfToTheBit) {
  const StudyPlan p = plan("kepler", {{"leapfrog", "kahan_li_6"},
                                      {"time_transformed", "suzuki_4"},
                                      {"adaptive_verlet", ""},
                                      {"jacobi_maupertuis", ""}});
  const auto once = numbers(work_precision(p, watch, never));
  EXPECT_GT(once.size(), 100u);
  EXPECT_EQ(once, numbers(work_precision(p, watch, never)));
  StudyPlan other = p;  // the initial value of a setting does not matter
  for (SchemeConfig& scheme : other.schemes)
    if (schemes()[scheme.scheme].id == "leapfrog") scheme.settings[0] *= 17;
  EXPECT_EQ(once, numbers(work_precision(other, watch, never)));
}

// Each point can be repeated as an ordinary run, whose error is measured by other code.
TEST(WorkPrecision, PointsAreRunsOfTheirOwn) {
  for (const bool at_end : {true, false}) {
    // The largest error of the damped one is far from its end.
    StudyPlan p = at_end ? plan("henon_heiles", {{"leapfrog", "kahan_li_6"}, {"jacobi_maupertuis", ""}}, 20)
                         : plan("damped_oscillator",
                                {{"contact_leapfrog", "none"}, {"contact_gauss", ""}, {"time_transformed", "none"}});
    p.at_end = at_end;
    const Study study = work_precision(p, watch, never);
    for (const StudyCurve& curve : study.curves) {
      const bool hybrid = curve.setting == "theta", timed = curve.setting != "step";
      ASSERT_GT(curve.points.size(), 4u);
      const StudyPoint& point = curve.points[4];
      Request request = with(p.scene, curve.scheme);
      if (hybrid) runs::set(request, "step", 0.02 * point.value / 0.008);
      runs::set(request, curve.setting, point.value);
      runs::only_final(request);
      runs::ask(request, "error");
      const Solution outcome = runs::go(request).outcome;
      EXPECT_EQ(outcome.cost.force_evaluations, point.force_evaluations);
      if (at_end)
        EXPECT_NEAR(runs::number(outcome.diagnostics, "error/final"), point.error, 1e-12 * point.error);
      else
        EXPECT_NEAR(runs::number(outcome.diagnostics, "error/max") / point.error, 1, 0.5);
      EXPECT_EQ(std::isnan(point.step), timed && !hybrid);
      if (hybrid) {
        EXPECT_NEAR(point.step, 0.02 * point.value / 0.008, 1e-12) << "it goes along with θ";
      }
    }
  }
}

TEST(WorkPrecision, CurvesBeginWhereRunsMeanSomethingAndEndAtRoundOff) {
  const StudyPlan p = plan("harmonic_oscillator", {{"leapfrog", "kahan_li_6"}, {"leapfrog", "kahan_li_8"}});
  const Study study = work_precision(p, watch, never);
  EXPECT_TRUE(study.left_out.empty());
  for (const StudyCurve& curve : study.curves) {
    for (std::size_t k = 1; k < curve.points.size(); ++k) {
      EXPECT_LT(curve.points[k].value, curve.points[k - 1].value);
      EXPECT_GT(curve.points[k].value, 0.6 * curve.points[k - 1].value);
    }
    EXPECT_FALSE(curve.points[0].error < 1) << "what fails is told once";
    EXPECT_LT(curve.points[1].error, 1);
    EXPECT_EQ(curve.points[1].status, ReturnCode::completed);
    EXPECT_LT(curve.points.back().error, 1e-12);
    for (const StudyPoint& point : curve.points) EXPECT_LE(point.force_evaluations, 300'000 * 3 / 2);
  }
}

TEST(WorkPrecision, ParetoIsAFront) {
  const StudyPlan p =
      plan("henon_heiles",
           {{"leapfrog", "none"}, {"leapfrog", "kahan_li_8"}, {"runge_kutta_4", ""}, {"galerkin_4", ""}}, 20);
  const Study study = work_precision(p, watch, never);
  const auto at = [&](const ParetoPoint& f) -> const StudyPoint& { return study.curves[f.curve].points[f.point]; };
  ASSERT_GT(study.pareto.size(), 3u);
  std::int64_t last = 0;
  for (const ParetoPoint& f : study.pareto) {
    EXPECT_GE(at(f).force_evaluations, last);
    last = at(f).force_evaluations;
    EXPECT_TRUE(f.fewest_forces || f.fastest);
  }
  for (std::size_t c = 0; c < study.curves.size(); ++c)
    for (std::size_t k = 0; k < study.curves[c].points.size(); ++k) {
      const StudyPoint& point = study.curves[c].points[k];
      if (!std::isfinite(point.error)) continue;
      const auto beats = [&](const ParetoPoint& f) {
        return f.fewest_forces && at(f).error <= point.error && at(f).force_evaluations <= point.force_evaluations;
      };
      EXPECT_TRUE(std::ranges::any_of(study.pareto, beats)) << "a point beyond the front";
      for (const ParetoPoint& f : study.pareto)
        EXPECT_FALSE(f.fewest_forces && point.error < at(f).error && point.force_evaluations < at(f).force_evaluations);
    }
}

TEST(WorkPrecision, TellsItsPointsAsTheyCome) {
  const StudyPlan p = plan("pendulum", {{"leapfrog", "none"}, {"leapfrog", "kahan_li_6"}});
  std::map<std::size_t, std::size_t> last;
  double floor = 0;
  StudyPlan told = p;
  told.begun = [&](const Study& study) { floor = study.floor; };
  const Study study = work_precision(
      told,
      [&](std::size_t index, const StudyCurve& curve) {
        EXPECT_GT(floor, 0) << "the head comes first";
        EXPECT_GT(curve.points.size(), last[index]);
        last[index] = curve.points.size();
        return true;
      },
      never);
  for (const auto& [index, count] : last) EXPECT_EQ(study.curves[index].points.size(), count);
  int left = 5;
  const Study ended = work_precision(
      p, [&](std::size_t, const StudyCurve&) { return --left > 0; }, never);
  EXPECT_EQ(left, 0);
  EXPECT_EQ(ended.left_out.size(), 2u);
}

TEST(WorkPrecision, KeepsItsBudgetAndSaysWhatIsMissing) {
  StudyPlan p = plan("kepler", {{"explicit_euler", ""}, {"leapfrog", "none"}, {"galerkin_4", "none"}});
  p.budget_seconds = 0.1;
  p.most_forces = 1'000'000'000;
  const runs::TurnedClock clock(1e-4);
  const Study study = work_precision(p, watch, never);
  EXPECT_LE(clock.now(), 0.11);
  ASSERT_EQ(study.left_out.size(), 3u);
  EXPECT_NE(study.left_out[0].text().find("explicit_euler: step from"), std::string::npos) << study.left_out[0].text();
  EXPECT_NE(study.left_out[0].text().find("budget"), std::string::npos);
  std::atomic<bool> gone{true};
  EXPECT_TRUE(work_precision(p, watch, gone).curves[1].points.empty());
}

TEST(WorkPrecision, MeasuresUpToWhereTheMotionEnds) {
  const Study study = work_precision(plan("lane_emden", {{"contact_leapfrog", "kahan_li_6"}}), watch, never);
  EXPECT_NEAR(study.end, 6.86, 0.04);
  ASSERT_FALSE(study.left_out.empty());
  EXPECT_NE(study.left_out[0].text().find("after t = 6.8"), std::string::npos) << study.left_out[0].text();
  EXPECT_LT(study.curves[0].points.back().error, 1e-11);
}

}  // namespace
