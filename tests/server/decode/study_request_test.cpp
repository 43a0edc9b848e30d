// Requests of the studies.
#include "server/decode/study_request.hpp"

#include <gtest/gtest.h>

#include "tests/server/cards.hpp"

namespace least::server {
namespace {

constexpr Caps study_caps{60, 1'000'000, 10'000};

template <class Plan>
Plan good(const Result<Plan, Faults>& plan) {
  for (std::size_t i = 0; !plan && i < plan.error().list().size(); ++i) {
    ADD_FAILURE() << plan.error().list()[i].pointer << " " << plan.error().list()[i].detail;
  }
  return plan ? *plan : Plan{};
}

Result<StudyPlan, Faults> study(std::string_view text) {
  return decode_work_precision(std::move(*parse_json(text)), test::cards(), study_caps);
}
Result<StabilityPlan, Faults> stability(std::string_view text) {
  return decode_stability(std::move(*parse_json(text)), test::cards(), study_caps);
}

TEST(DecodeStudy, ReadsAPlan) {
  StudyPlan plan = good(study(R"({"problem":{"id":"swing","preset":"heavy","level":5},"initial":{"p":3},"until":{"t":9},
    "schemes":["runge_kutta_4",{"id":"leapfrog","composition":"yoshida_4"},{"id":"own_clock","preset":"paper"},
               {"id":"leapfrog","step":0.5}],"error":"max","budget_seconds":7})"));
  EXPECT_EQ(plan.scene.scene->card().id, "swing");
  EXPECT_EQ(plan.scene.scene->parameters, (std::vector<double>{10, 5}));
  EXPECT_EQ(plan.scene.scene->initial, (std::vector<double>{2, 3}));
  EXPECT_EQ(plan.scene.scene->start, 5);
  EXPECT_EQ(plan.scene.end, 9);
  EXPECT_FALSE(plan.scene.until_steps);
  EXPECT_FALSE(plan.at_end);
  EXPECT_EQ(plan.budget_seconds, 7);
  ASSERT_EQ(plan.schemes.size(), 4u);  // in their order
  EXPECT_EQ(plan.schemes[0].scheme, 1u);
  EXPECT_EQ(plan.schemes[0].settings, std::vector<double>{0.1});
  EXPECT_EQ(plan.schemes[1].settings, (std::vector<double>{0.1, 1}));
  EXPECT_EQ(plan.schemes[2].settings[2], 4);
  EXPECT_EQ(plan.schemes[3].settings, (std::vector<double>{0.5, 0}));

  plan = good(study(R"({"problem":"swing","schemes":["leapfrog"]})"));
  EXPECT_EQ(plan.scene.end, 20);
  EXPECT_TRUE(plan.at_end);
  EXPECT_EQ(plan.budget_seconds, 10);
  const auto poor = decode_work_precision(std::move(*parse_json(R"({"problem":"swing","schemes":["leapfrog"]})")),
                                          test::cards(), {2, 100, 100});
  EXPECT_EQ(good(poor).budget_seconds, 2) << "the cap is below the default";
}

TEST(DecodeStudy, AllIsEverySchemeThatFitsBareAndAsRecommended) {
  static const std::vector<SchemeCard> schemes = [] {
    std::vector<SchemeCard> all(test::cards().schemes.begin(), test::cards().schemes.end());
    all[0].recommended = "yoshida_4";
    return all;
  }();
  const Cards cards{test::cards().problems, schemes};
  const auto plan =
      good(decode_work_precision(std::move(*parse_json(R"({"problem":"swing","schemes":"all"})")), cards, study_caps));
  ASSERT_EQ(plan.schemes.size(), 4u);
  EXPECT_EQ(plan.schemes[0].settings, (std::vector<double>{0.1, 0}));
  EXPECT_EQ(plan.schemes[1].scheme, 0u);
  EXPECT_EQ(plan.schemes[1].settings, (std::vector<double>{0.1, 1}));
  EXPECT_EQ(plan.schemes[2].scheme, 1u);
  EXPECT_EQ(plan.schemes[3].scheme, 2u);
  const auto flow =
      good(decode_work_precision(std::move(*parse_json(R"({"problem":"flow","schemes":"all"})")), cards, study_caps));
  ASSERT_EQ(flow.schemes.size(), 1u);
  EXPECT_EQ(flow.schemes[0].scheme, 1u);
}

TEST(DecodeStudy, ReportsEveryFaultAtOnce) {
  const auto plan = study(R"({"problem":{"id":"flow","mass":-1},"initial":{"v":1},"until":{"steps":5},
    "schemes":["leapfrog",{"id":"runge_kutta_4","step":0},"auto",{"id":"auto","accuracy":1e-3},3,{"step":1},
               {"id":"own_clock","stages":8}],
    "error":"mean","budget_seconds":61,"limits":{}})");
  ASSERT_FALSE(plan);
  const Faults& faults = plan.error();
  for (const char* pointer :
       {"/problem/mass", "/initial/v", "/until/steps", "/schemes/0", "/schemes/1/step", "/schemes/2", "/schemes/3",
        "/schemes/4", "/schemes/5/id", "/schemes/6/id", "/error", "/budget_seconds", "/limits"}) {
    EXPECT_TRUE(faults.at(pointer)) << pointer;
  }
  EXPECT_EQ(faults.list().size(), 13u);
  for (const Fault& fault : faults.list()) {
    if (fault.pointer == "/schemes/0") {
      EXPECT_EQ(fault.detail,
                "leapfrog cannot run flow: it needs a separable Hamiltonian, and flow offers a vector field");
    }
    if (fault.pointer == "/budget_seconds") {
      EXPECT_EQ(fault.allowed, "(0, 60]");
    }
  }
}

TEST(DecodeStudy, FindsFaultsAtTheirPlaceAndAlone) {
  std::string many = R"({"problem":"swing","schemes":["leapfrog")";
  for (std::size_t i = 0; i < most_schemes; ++i) many += R"(,"leapfrog")";
  for (const auto& [text, pointer] : std::vector<std::pair<std::string, std::string>>{
           {"[]", ""},
           {R"({"schemes":["leapfrog"]})", "/problem"},
           {R"({"schemes":"all"})", "/problem"},
           {R"({"problem":"swing"})", "/schemes"},
           {R"({"problem":"swing","schemes":[]})", "/schemes"},
           {R"({"problem":"swing","schemes":"leapfrog"})", "/schemes"},
           {R"({"problem":"swing","schemes":{"id":"leapfrog"}})", "/schemes"},
           {many + "]}", "/schemes"},
           {R"({"problem":"swing","schemes":["leapfrgo"]})", "/schemes/0"},
           {R"({"problem":"swing","schemes":[{"id":"own_clock","stages":8}]})", "/schemes/0/stages"},
           {R"({"problem":"swing","schemes":["leapfrog"],"until":{}})", "/until"},
           {R"({"problem":"swing","schemes":["leapfrog"],"until":{"t":0}})", "/until/t"},
           {R"({"problem":"swing","schemes":["leapfrog"],"budget_seconds":0})", "/budget_seconds"},
           {R"({"problem":"swing","schemes":["leapfrog"],"error":true})", "/error"}}) {
    const auto plan = study(text);
    ASSERT_FALSE(plan) << text;
    ASSERT_EQ(plan.error().list().size(), 1u) << text;
    EXPECT_EQ(plan.error().list()[0].pointer, pointer) << text;
  }
}

TEST(DecodeStability, ReadsSceneAndSchemes) {
  const auto plan =
      good(stability(R"({"problem":{"id":"swing","preset":"heavy"},"schemes":["leapfrog","own_clock"]})"));
  EXPECT_EQ(plan.scene.scene->start, 5);
  EXPECT_EQ(plan.scene.end, 25);
  EXPECT_EQ(plan.schemes.size(), 2u);
  EXPECT_EQ(plan.scene.limits.seconds, 10);
  const auto faulty = stability(R"({"problem":"swing","schemes":["leapfrog"],"until":{"t":5},"error":"max"})");
  ASSERT_FALSE(faulty);
  EXPECT_TRUE(faulty.error().at("/until") && faulty.error().at("/error"));
  EXPECT_TRUE(stability(R"({"problem":"swing","initial":{"t":1e300},"schemes":"all"})").error().at("/until/t"));
}

}  // namespace
}  // namespace least::server
