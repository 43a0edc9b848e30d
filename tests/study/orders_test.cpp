// The observed order of every pair in the catalogue, from studies in double precision, is the declared one. The
// tolerance is wide: the largest error along a run follows a power of the step only where higher powers are negligible,
// and from order 8 on round-off comes first. The laws measure the orders of fixed steps to a tenth, in longer numbers
// (OrderIsAsDeclared).
#include <cmath>
#include <iostream>

#include "core/study/error_study.hpp"
#include "tests/study/studies.hpp"

namespace {

using namespace studies;

/// ordinary() returns a problem's default scene up to an ordinary time, before which differences of the start have not
/// grown much. Where the equations of motion are singular at the start, which lowers orders, it begins later.
Request ordinary(std::string_view problem) {
  Request request = scene(problem);
  if (problem == "damped_kepler")  // at e = .9 rounding hides the pure powers of eight and ten
    for (const auto& [name, value] : {std::pair{"x", 0.5}, {"py", std::sqrt(3.0)}}) runs::begin(request, name, value);
  const double span = request.end - runs::scene(request).start;
  request.end = runs::scene(request).start + 0.37 * span;
  while (conditioning(request, always)->most_growth > 300)
    request.end -= 0.5 * (request.end - runs::scene(request).start);
  if (!runs::regular_start(request, 0.05)) return request;
  const double later = runs::scene(request).start + 0.1 * span;
  const auto there = truth(request, {later}, always);
  std::ranges::copy(there->states.at(0), runs::scene(request).initial.begin());
  runs::scene(request).start = later;
  return request;
}

class Orders : public testing::TestWithParam<std::size_t> {};

TEST_P(Orders, AreTheDeclaredOnes) {
  StudyPlan plan;
  plan.scene = ordinary(runs::problem_cards()[GetParam()].id);
  plan.schemes = catalogue_candidates(*plan.scene.scene->mechanics, {});
  plan.at_end = false;
  plan.budget_seconds = 100;
  plan.most_forces = 100'000;
  const Study study = work_precision(plan, watch, never);
  ASSERT_TRUE(study.left_out.empty()) << study.left_out[0];
  int measured = 0, waived = 0;
  for (const StudyCurve& curve : study.curves) {
    if (curve.expected_order == 0) continue;
    const std::string pair = std::string(runs::problem_cards()[GetParam()].id) + " " + name(curve.scheme);
    if (std::isnan(curve.observed_order)) {
      std::cout << "waived: " << pair << ": " << curve.why << '\n';
      waived += curve.expected_order <= 6 && curve.points.size() > 1;
      continue;
    }
    // At order 10 a few more steps than resolve a periapsis passage already reach round-off.
    const double slack = curve.expected_order <= 6 ? 0.45 : curve.expected_order <= 8 ? 1.5 : 2.5;
    EXPECT_GT(curve.observed_order, curve.expected_order - slack) << pair;
    EXPECT_LT(curve.observed_order,
              curve.expected_order + (curve.expected_order <= 6 ? slack : 0.4 * curve.expected_order))
        << pair;
    measured += curve.expected_order <= 6;
  }
  EXPECT_GE(measured, 2 * waived) << "hardly an order could be measured";
}
INSTANTIATE_TEST_SUITE_P(AllProblems, Orders, testing::Range<std::size_t>(0, runs::problem_cards().size()),
                         [](const auto& which) { return std::string(runs::problem_cards()[which.param].id); });

}  // namespace
