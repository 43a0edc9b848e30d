// What holds for the derivatives of every problem of the catalogue, over HTTP.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/catalogue/catalogue.hpp"
#include "tests/server/fixture.hpp"
#include "tests/support/runs.hpp"

namespace least::server::test {
namespace {

class SensitivityLaws : public Asking {
 protected:
  /// By its whole start, along its motion: of second order over a while in which differences are good.
  static Json of_whole_start(const ProblemCard& card, int order, double most = 1) {
    const double start = card.id == "lane_emden" ? 0.5 : 0;
    Json request{{"problem", card.id},
                 {"initial", {{"t", start}}},
                 {"scheme", {{"id", "taylor"}, {"tolerance", 1e-15}}},
                 {"until", start + std::min(most, 0.1 * card.span)},
                 {"record", {{"every", 0}}},
                 {"sensitivities", {{"by", "initial"}, {"of", "motion"}, {"order", order}}}};
    if (card.id == "lane_emden") request["initial"].update({{"q", 0.95}, {"p", -0.04}});
    return request;
  }
  static double largest(const Json& rows) {
    double most = 1;
    for (const auto& row : rows)
      for (const double slope : row) most = std::max(most, std::abs(slope));
    return most;
  }
};

TEST_F(SensitivityLaws, TheWholeMapKeepsItsStructure) {
  for (const auto& problem : problem_list()) {
    SCOPED_TRACE(problem->card().id);
    const Json found = answer(of_whole_start(problem->card(), 1, 5))["sensitivities"];
    const Json& structure = found["structure"];
    if (structure["kind"] == "none") continue;
    EXPECT_LT(structure["max_defect"], 1e-12 * largest(found["final"])) << structure;
  }
}

TEST_F(SensitivityLaws, SecondDerivativesAreDifferencesOfTheFirst) {
  for (const auto& problem : problem_list()) {
    const ProblemCard& card = problem->card();
    if (card.id == "lane_emden") continue;  // its equations switch sides
    SCOPED_TRACE(card.id);
    const Json made = answer(of_whole_start(card, 2));
    const Json& found = made["sensitivities"];
    const double size = largest(found["second"]["final"]);
    for (std::size_t b = 0; b < found["by"].size(); ++b) {
      const Json::json_pointer place(found["by"][b].get<std::string>());
      const double value = made[place], step = 2e-4 * std::max(0.1, std::abs(value));
      const auto moved = [&](double by) {
        Json request = of_whole_start(card, 1);
        request[place] = value + by;
        return answer(request)["sensitivities"]["final"];
      };
      const Json up = moved(step), down = moved(-step), far_up = moved(2 * step), far_down = moved(-2 * step);
      for (std::size_t pair = 0; pair < found["second"]["pairs"].size(); ++pair) {
        const auto& two = found["second"]["pairs"][pair];
        if (two[1] != b) continue;
        const std::size_t a = two[0];
        for (std::size_t i = 0; i < found["rows"].size(); ++i) {
          const auto at = [&](const Json& final) { return final[i][a].get<double>(); };
          const double slope = (8 * (at(up) - at(down)) - (at(far_up) - at(far_down))) / (12 * step);
          EXPECT_NEAR(found["second"]["final"][i][pair], slope, 1e-6 * size) << found["rows"][i] << " " << two;
        }
      }
    }
  }
}

// Second derivatives of a body that is too fast to be followed end where times can no longer be told apart: halving the
// step, which once went on for good, comes to two neighbouring numbers.
TEST_F(SensitivityLaws, AStepIsHalvedNoFurtherThanTimesCanTell) {
  runs::problem_called("kepler");
  const Json found = answer(Json::parse(R"({"problem":"kepler","until":{"t":1},"record":{"every":0},
      "initial":{"x":1,"y":0,"px":0,"py":9007199254740992},"scheme":{"id":"runge_kutta_4","step":0.1},
      "sensitivities":{"by":["/initial/px"],"of":"motion","order":2}})"))["sensitivities"];
  EXPECT_TRUE(found["second"]["final"].is_null()) << found;
  EXPECT_TRUE(found.contains("reason")) << found;
}

}  // namespace
}  // namespace least::server::test
