// Studies as JSON, whole and line by line.
#include "server/encode/study_json.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "least_version.hpp"
#include "server/decode/study_request.hpp"
#include "tests/server/cards.hpp"

namespace least::server {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

struct StudyExample {
  StudyPlan plan;
  least::Study study;
  PlanWithCards asked{plan, test::cards()};

  StudyExample() {
    auto parsed = parse_json(R"({"problem":"swing","schemes":[{"id":"leapfrog","step":0.5,"composition":"yoshida_4"},
      {"id":"own_clock","kappa":"energy"}],"error":"max"})");
    plan = *decode_work_precision(std::move(*parsed), test::cards(), {});
    study.how = "closed form";
    study.uncertainty = 1e-16;
    study.floor = 1e-14;
    study.growth = 12.5;
    study.end = 19;
    study.curves = {{plan.schemes[0], "step", {}, 3.99, 4, ""}, {plan.schemes[1], "sigma", {}, nan, 0, "too few"}};
    study.curves[0].points = {{1, 1, nan, 40, 1e-6, ReturnCode::unstable_step}, {0.25, 0.25, 1e-3, 160, 2e-6, {}}};
    study.curves[1].points = {{0.5, nan, 0.5, 99, 3e-6, {}}};
    study.pareto = {{0, 1, true, false}};
    study.left_out = {"own_clock below 0.5: the budget was over"};
  }
};

const std::string echo =
    R"({"version":")" + std::string(version) +
    R"(","problem":{"id":"swing","mass":1,"level":3},"initial":{"t":0,"q":1,"p":0},"until":{"t":20},)"
    R"("error":"max","norm":"absolute","budget_seconds":10,"reference":{"how":"closed form","uncertainty":1e-16},"floor":1e-14,)"
    R"("growth":12.5,"chaotic":false,"end":19,)";
constexpr const char* first_curve =
    R"("scheme":{"id":"leapfrog","step":0.5,"composition":"yoshida_4"},"setting":"step",)";
constexpr const char* second_curve =
    R"("scheme":{"id":"own_clock","keep":true,"critical":0.5,"stages":2,"kappa":"energy","step":0.1},"setting":"sigma",)";
constexpr const char* found =
    R"("pareto":[{"error":0.001,"seconds":2e-06,"force_evaluations":160,"scheme":{"id":"leapfrog","step":0.25,)"
    R"("composition":"yoshida_4"},"curve":0,"point":1,"fewest_forces":true,"fastest":false}],)"
    R"("left_out":["own_clock below 0.5: the budget was over"],)";

TEST(EncodeStudy, WritesTheWholeAnswer) {
  const StudyExample example;
  EXPECT_EQ(encode_study(example.asked, example.study, ReturnCode::completed),
            std::string(echo) + R"("curves":[{)" + first_curve +
                R"("points":[{"value":1,"step":1,"error":null,"force_evaluations":40,"seconds":1e-06,)"
                R"("status":"unstable_step"},{"value":0.25,"step":0.25,"error":0.001,"force_evaluations":160,)"
                R"("seconds":2e-06,"status":"completed"}],"observed_order":3.99,"expected_order":4},{)" +
                second_curve +
                R"("points":[{"value":0.5,"step":null,"error":0.5,"force_evaluations":99,"seconds":3e-06,)"
                R"("status":"completed"}],"observed_order":null,"expected_order":null,"why":"too few"}],)" +
                found + "\"status\":\"completed\"}\n");
}

TEST(EncodeStudy, WritesLines) {
  const StudyExample example;
  EXPECT_EQ(encode_study_head(example.asked, example.study),
            std::string(echo).insert(1, R"("kind":"head",)") +
                R"("schemes":[{"id":"leapfrog","step":0.5,"composition":"yoshida_4"},)" +
                R"({"id":"own_clock","keep":true,"critical":0.5,"stages":2,"kappa":"energy","step":0.1}]})" + "\n");
  EXPECT_EQ(encode_study_point(example.asked, 0, example.study.curves[0]),
            std::string(R"({"kind":"point","curve":0,)") + first_curve +
                R"("point":{"value":0.25,"step":0.25,"error":0.001,"force_evaluations":160,"seconds":2e-06,)"
                R"("status":"completed"}})" +
                "\n");
  EXPECT_EQ(encode_study_end(example.asked, example.study, ReturnCode::deadline),
            std::string(R"({"kind":"end","curves":[{)") + first_curve +
                R"("observed_order":3.99,"expected_order":4},{)" + second_curve +
                R"("observed_order":null,"expected_order":null,"why":"too few"}],)" + found +
                R"("status":"stopped","stop":{"reason":"deadline"}})" + "\n");
}

TEST(EncodeStability, WritesLimitsAndWhatIsMissing) {
  const Cards cards = test::cards();
  auto parsed = parse_json(R"({"problem":"swing","schemes":["leapfrog","own_clock","runge_kutta_4"]})");
  const auto plan = *decode_stability(std::move(*parsed), cards, {});
  const std::vector<StabilityLimit> limits{{plan.schemes[0], 2, "energy_growth", 2, {{2.5, 3}}},
                                           {plan.schemes[1], nan, {}, nan, {}, nan, "no fixed steps"}};
  const Json json = Json::parse(encode_stability({plan.scene, plan.schemes, limits, cards}, ReturnCode::deadline));
  EXPECT_EQ(json["limits"][0].dump(), R"({"scheme":{"id":"leapfrog","step":0.1,"composition":"none"},"step":2,)"
                                      R"("failure":"energy_growth","theory":2,"islands":[[2.5,3]]})");
  EXPECT_EQ(json["limits"].size(), 2u);
  for (const char* key : {"step", "failure", "theory"}) EXPECT_EQ(json["limits"][1][key], nullptr);
  EXPECT_EQ(json["limits"][1]["why"], "no fixed steps");
  EXPECT_EQ(json["left_out"].size(), 1u);
  EXPECT_EQ(json["stop"]["reason"], "deadline");
}

}  // namespace
}  // namespace least::server
