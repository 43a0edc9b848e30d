#include "server/decode/simulate_request.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/server/cards.hpp"

namespace least::server {
namespace {

constexpr Caps caps{60, 1'000'000, 10'000};

Result<SimulateRequest, Faults> decoded(std::string_view text) {
  auto parsed = parse_json(text);
  EXPECT_TRUE(parsed) << text;
  return decode(std::move(*parsed), test::cards(), caps);
}

SimulateRequest ordered(std::string_view text) {
  const auto order = decoded(text);
  for (std::size_t i = 0; !order && i < order.error().list().size(); ++i) {
    ADD_FAILURE() << text << ": " << order.error().list()[i].pointer << " " << order.error().list()[i].detail;
  }
  return order ? *order : SimulateRequest{};
}

Request good(std::string_view text) {
  const SimulateRequest order = ordered(text);
  EXPECT_FALSE(order.wish) << text;
  return order.run;
}

Faults bad(std::string_view text) {
  const auto request = decoded(text);
  EXPECT_FALSE(request) << text;
  return request ? Faults{} : request.error();
}

Fault fault_at(const Faults& faults, const std::string& pointer) {
  for (const auto& fault : faults.list()) {
    if (fault.pointer == pointer) return fault;
  }
  ADD_FAILURE() << "no fault at " << pointer;
  return {};
}

TEST(Decode, WhatIsNoObjectIsToldTheObjectItMeant) {
  const Faults faults = bad(R"({"problem":"swing","scheme":"leapfrog","initial":[1,0.5],"columns":"q"})");
  EXPECT_EQ(fault_at(faults, "/initial").detail, R"(must be an object, like {"q": 1, "p": 0.5})");
  EXPECT_EQ(fault_at(faults, "/columns").detail, R"(must be a list of columns, like ["q"])");
  const Faults more = bad(R"({"problem":"swing","scheme":"leapfrog","record":100})");
  EXPECT_EQ(fault_at(more, "/record").detail, R"(must be an object, like {"every": 100})");
}

TEST(Decode, TwoIdsAreACompleteRequest) {
  const Request request = good(R"({"problem":"swing","scheme":"leapfrog"})");
  EXPECT_EQ(request.scene->parameters, (std::vector<double>{1, 3}));
  EXPECT_EQ(request.scene->initial, (std::vector<double>{1, 0}));
  EXPECT_EQ(request.settings, (std::vector<double>{0.1, 0}));  // the step is the problem's suggestion
  EXPECT_EQ(request.scene->start, 0);
  EXPECT_FALSE(request.until_steps);
  EXPECT_EQ(request.end, 20);
  EXPECT_EQ(request.record.mode, Record::Mode::every);
  EXPECT_EQ(request.record.count, 1);  // 200 steps
  EXPECT_EQ(request.columns, (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_EQ(request.diagnostics, std::vector<std::size_t>{0});
  EXPECT_EQ(request.limits.seconds, 10);
  EXPECT_EQ(request.limits.steps, 1'000'000);  // the cap is below the default
  EXPECT_EQ(request.limits.samples, 10'000);
}

TEST(Decode, ReadsEveryKindOfParameter) {
  const Request request =
      good(R"({"problem":{"id":"swing","level":5.0},"scheme":{"id":"own_clock","keep":false,"critical":null}})");
  EXPECT_EQ(request.scene->parameters, (std::vector<double>{1, 5}));
  EXPECT_EQ(request.settings[0], 0);
  EXPECT_TRUE(std::isnan(request.settings[1]));
  EXPECT_EQ(request.settings[2], 2);
  EXPECT_EQ(request.record.mode, Record::Mode::samples);  // a scheme with its own clock has no stride to count in
  EXPECT_EQ(good(R"({"problem":"swing","scheme":{"id":"leapfrog","composition":"yoshida_4"}})").settings[1], 1);
  EXPECT_EQ(good(R"({"problem":"swing","scheme":"own_clock"})").settings[1], 0.5);  // suggested
}

TEST(Decode, PresetsYieldToWhatIsSaid) {
  Request request = good(R"({"problem":{"id":"swing","preset":"heavy"},"scheme":"leapfrog"})");
  EXPECT_EQ(request.scene->parameters[0], 10);
  EXPECT_EQ(request.scene->initial[0], 2);
  EXPECT_EQ(request.scene->start, 5);
  EXPECT_EQ(request.end, 25);
  request = good(R"({"problem":{"id":"swing","preset":"heavy","mass":4},"initial":{"q":3},"scheme":"leapfrog"})");
  EXPECT_EQ(request.scene->parameters[0], 4);
  EXPECT_EQ(request.scene->initial[0], 3);
  EXPECT_NE(fault_at(bad(R"({"problem":{"id":"swing","preset":"haevy"},"scheme":"leapfrog"})"), "/problem/preset")
                .detail.find("heavy"),
            std::string::npos);
  fault_at(bad(R"({"problem":{"id":"flow","preset":"heavy"},"scheme":"runge_kutta_4"})"), "/problem/preset");
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(Decode, PresetsOfASchemeWinOverSuggestionsAndYieldToWhatIsSaid) {
  Request request = good(R"({"problem":"swing","scheme":{"id":"own_clock","preset":"paper"}})");
  EXPECT_EQ(request.settings[0], 1);
  EXPECT_TRUE(std::isnan(request.settings[1]));  // 0.5 is suggested
  EXPECT_EQ(request.settings[2], 4);
  EXPECT_EQ(request.settings[3], 1);
  const char* said = R"({"id":"own_clock","preset":"paper","critical":3,"stages":null})";
  request = good(std::string(R"({"problem":{"id":"swing","preset":"light"},"scheme":)") + said + "}");
  EXPECT_EQ(request.settings[1], 3);
  EXPECT_TRUE(std::isnan(request.settings[2]));
  request = good(R"({"problem":"swing","scheme":{"id":"own_clock","preset":"kepler"}})");
  EXPECT_EQ(request.settings[0], 0);
  EXPECT_EQ(request.settings[1], 0.5);  // what it does not name is suggested as ever
  EXPECT_TRUE(std::isnan(request.settings[3]));

  const Fault unknown =
      fault_at(bad(R"({"problem":"swing","scheme":{"id":"own_clock","preset":"papre"}})"), "/scheme/preset");
  EXPECT_TRUE(contains(unknown.detail, "did you mean \"paper\"?")) << unknown.detail;
  EXPECT_EQ(unknown.allowed, "paper, kepler");
  EXPECT_EQ(
      fault_at(bad(R"({"problem":"swing","scheme":{"id":"leapfrog","preset":"paper"}})"), "/scheme/preset").detail,
      "leapfrog has no presets");
}

TEST(Decode, ASuggestionThatIsNotANumberSuggestsNothing) {
  Request request = good(R"({"problem":"swing","scheme":"own_clock"})");
  EXPECT_EQ(request.settings[3], 1);
  EXPECT_EQ(request.settings[1], 0.5);
  request = good(R"({"problem":{"id":"swing","preset":"light"},"scheme":"own_clock"})");
  EXPECT_EQ(request.settings[1], 0.25);
  EXPECT_EQ(request.settings[4], 0.1);  // the problem's own
}

TEST(Decode, AWordMayStandForANumber) {
  const auto with = [](const std::string& key, const std::string& value) {
    return R"({"problem":"swing","scheme":{"id":"own_clock",")" + key + "\":" + value + "}}";
  };
  EXPECT_TRUE(std::isnan(good(with("kappa", R"("energy")")).settings[3]));
  EXPECT_EQ(good(with("kappa", "2.5")).settings[3], 2.5);
  for (const char* value : {R"("enrgy")", "null", "true", "0", "9.5"}) {
    const Fault fault = fault_at(bad(with("kappa", value)), "/scheme/kappa");
    EXPECT_TRUE(contains(fault.detail, R"( or "energy")")) << fault.detail;
    EXPECT_EQ(fault.allowed, R"((0, 9] or "energy")");
    EXPECT_EQ(fault.value, value);
  }
  EXPECT_EQ(fault_at(bad(with("kappa", "null")), "/scheme/kappa").detail, R"(must be a number or "energy")");
  const Fault fault = fault_at(bad(with("critical", R"("energy")")), "/scheme/critical");
  EXPECT_EQ(fault.detail, "must be a number or null: nobody knows the name energy");
  EXPECT_EQ(fault.allowed, "[0, 9] or null");
  EXPECT_EQ(fault_at(bad(with("stages", "2.5")), "/scheme/stages").detail, "must be a whole number or null");
}

TEST(Decode, SettingsThatConflictAreFaultsAtTheOneToChange) {
  const auto with = [](const std::string& settings, const std::string& more = "") {
    return R"({"problem":"swing","scheme":{"id":"own_clock",)" + settings + "}" + more + "}";
  };
  const Faults faults = bad(with(R"("stages":8)", R"(,"recrod":{})"));
  const Fault fault = fault_at(faults, "/scheme/stages");
  EXPECT_EQ(fault.detail, "eight do not go with keep on swing");
  EXPECT_EQ(fault.value, "8");
  EXPECT_EQ(fault.allowed, "[1, 7]");
  EXPECT_TRUE(faults.at("/recrod")) << "with all other faults at once";
  good(with(R"("stages":8,"keep":false)"));
  // Settings that could not be read are not compared with each other, nor with a problem they cannot run.
  const Faults unread = bad(with(R"("stages":8,"kappa":true)"));
  EXPECT_FALSE(unread.at("/scheme/stages"));
  EXPECT_EQ(unread.list().size(), 1u);
  const Faults misfit = bad(R"({"problem":"flow","scheme":{"id":"own_clock","stages":8}})");
  EXPECT_TRUE(misfit.at("/scheme/id"));
  EXPECT_EQ(misfit.list().size(), 1u);
}

TEST(Decode, ASchemeWithItsOwnClockCountsItsOwnSteps) {
  const auto with = [](const std::string& plan) { return R"({"problem":"swing","scheme":"own_clock",)" + plan + "}"; };
  Request request = good(with(R"("until":{"steps":5000})"));
  EXPECT_TRUE(request.until_steps);
  EXPECT_EQ(request.steps, 5000);
  EXPECT_EQ(request.record.mode, Record::Mode::every);
  EXPECT_EQ(request.record.count, 6);
  // The settings have a step of 0.1: it is not used for the number of steps until a time,
  request = good(with(R"("until":{"t":1e300},"record":{"every":1},"limits":{"samples":10})"));
  EXPECT_EQ(request.record.count, 1);
  EXPECT_EQ(good(with(R"("until":{"t":20})")).record.mode, Record::Mode::samples);
  // nor for the time when the steps end.
  good(with(R"("until":{"steps":5},"record":{"times":[1,1e9]})"));
  good(with(R"("until":{"steps":5},"record":{"every":0})"));
  EXPECT_TRUE(bad(with(R"("until":{"steps":5000},"record":{"every":1},"limits":{"samples":100})")).at("/record/every"));
  const Faults faults = bad(with(R"("until":{"steps":5000},"record":{"samples":10})"));
  ASSERT_EQ(faults.list().size(), 1u);
  const Fault fault = fault_at(faults, "/record/samples");
  EXPECT_TRUE(contains(fault.detail, "sets its own clock")) << fault.detail;
  EXPECT_EQ(fault.value, "10");
  good(with(R"("until":{"t":20},"record":{"samples":10})"));
  // A step that cannot be read does not make the scheme one that chooses its steps.
  EXPECT_FALSE(
      bad(R"({"problem":"swing","scheme":{"id":"leapfrog","step":0},"until":{"steps":5},"record":{"samples":5}})")
          .at("/record/samples"));
}

TEST(Decode, AutoIsAWishInPlaceOfAScheme) {
  const auto with = [](const std::string& scheme, const std::string& more = "") {
    return R"({"problem":"swing","scheme":)" + scheme + more + "}";
  };
  SimulateRequest order = ordered(with(R"({"id":"auto","accuracy":1e-6,"keep":["momenta","energy"]})"));
  ASSERT_TRUE(order.wish);
  EXPECT_EQ(order.wish->accuracy, 1e-6);
  EXPECT_TRUE(order.wish->keep.momenta && order.wish->keep.energy && !order.wish->keep.structure);
  EXPECT_EQ(order.run.end, 20);
  EXPECT_EQ(order.run.record.mode, Record::Mode::samples);  // how many steps there will be is not known
  order = ordered(with(R"({"id":"auto","accuracy":null,"seconds":0.05,"keep":[]})", R"(,"record":{"every":3})"));
  ASSERT_TRUE(order.wish);
  EXPECT_TRUE(std::isnan(order.wish->accuracy));
  EXPECT_EQ(order.wish->seconds, 0.05);
  EXPECT_FALSE(order.wish->keep.momenta || order.wish->keep.energy || order.wish->keep.structure);
  EXPECT_EQ(order.run.record.count, 3);
  EXPECT_TRUE(ordered(R"({"problem":"flow","scheme":{"id":"auto","accuracy":1e-6}})").wish);  // fits every problem

  const Faults faults = bad(with(R"({"id":"auto","step":1,"accuracy":2,"seconds":61,"keep":["energy","energy","x"]})",
                                 R"(,"until":{"steps":5},"recrod":{})"));
  for (const char* pointer : {"/scheme", "/scheme/step", "/scheme/accuracy", "/scheme/seconds", "/scheme/keep/1",
                              "/scheme/keep/2", "/until/steps", "/recrod"}) {
    EXPECT_TRUE(faults.at(pointer)) << pointer;
  }
  EXPECT_EQ(faults.list().size(), 8u);
  EXPECT_EQ(fault_at(faults, "/scheme/seconds").allowed, "(0, 60]");
  EXPECT_TRUE(contains(fault_at(faults, "/until/steps").detail, "auto chooses the step"));
  for (const char* neither : {R"("auto")", R"({"id":"auto","keep":["energy"]})", R"({"id":"auto","accuracy":null})"}) {
    order = ordered(with(neither));  // a bare id is complete, as of every scheme
    ASSERT_TRUE(order.wish) << neither;
    EXPECT_EQ(order.wish->accuracy, auto_card().parameters[0].value) << neither;
    EXPECT_TRUE(std::isnan(order.wish->seconds)) << neither;
  }
  EXPECT_TRUE(bad(with(R"({"id":"auto","accuracy":1e-6,"keep":"energy"})")).at("/scheme/keep"));
  EXPECT_TRUE(bad(with(R"({"id":"auto","accuracy":1e-6})", R"(,"until":{"t":-1})")).at("/until/t"));
  EXPECT_TRUE(contains(fault_at(bad(with("\"atuo\"")), "/scheme").detail, "did you mean \"auto\"?"));
}

TEST(Decode, TheDefaultStrideIsTheSmallestThatKeepsAThousandSamples) {
  for (const auto& [steps, every] : {std::pair{999, 1}, {1000, 2}, {1999, 2}, {2000, 3}, {999'999, 1000}}) {
    const std::string text =
        R"({"problem":"swing","scheme":"leapfrog","until":{"steps":)" + std::to_string(steps) + "}}";
    EXPECT_EQ(good(text).record.count, every) << steps;
  }
  EXPECT_EQ(
      good(R"({"problem":"swing","scheme":"leapfrog","until":{"steps":99},"limits":{"samples":30}})").record.count, 10);
}

TEST(Decode, CountsStepsWithARoundOffMargin) {
  // 0.3/0.1 is below 3 in doubles; three samples at the stride are four rows
  const std::string head =
      R"({"problem":"swing","scheme":{"id":"leapfrog","step":0.1},"until":{"t":0.3},"record":{"every":1},)";
  good(head + R"("limits":{"samples":12}})");
  EXPECT_TRUE(bad(head + R"("limits":{"samples":11}})").at("/record/every"));
}

TEST(Decode, ReportsEveryFaultAtOnce) {
  const Faults faults = bad(R"({
    "problem": {"id": "swing", "mass": -1, "level": 2.5, "colour": "red"},
    "initial": {"q": "one", "v": 3, "p": true},
    "scheme": {"id": "leapfrog", "step": 0, "composition": "yoshida4"},
    "until": {"t": -2},
    "record": {"every": 1.5},
    "columns": ["t", "enrgy", "t", 4],
    "diagnostics": "energy",
    "limits": {"seconds": 61, "steps": 0, "samples": 1e9, "money": 1},
    "recrod": {}})");
  for (const char* pointer :
       {"/problem/mass", "/problem/level", "/problem/colour", "/initial/q", "/initial/v", "/initial/p", "/scheme/step",
        "/scheme/composition", "/until/t", "/record/every", "/columns/1", "/columns/2", "/columns/3", "/diagnostics",
        "/limits/seconds", "/limits/steps", "/limits/samples", "/limits/money", "/recrod"}) {
    EXPECT_TRUE(faults.at(pointer)) << pointer;
  }
  EXPECT_EQ(faults.list().size(), 19u);
  const Fault mass = fault_at(faults, "/problem/mass");
  EXPECT_EQ(mass.detail, "must be greater than 0");
  EXPECT_EQ(mass.value, "-1");
  EXPECT_EQ(mass.allowed, "(0, 1e3]");
  EXPECT_EQ(fault_at(faults, "/limits/seconds").allowed, "(0, 60]");
  EXPECT_NE(fault_at(faults, "/recrod").detail.find("did you mean \"record\"?"), std::string::npos);
  EXPECT_NE(fault_at(faults, "/columns/1").detail.find("did you mean \"energy\"?"), std::string::npos);
  EXPECT_NE(fault_at(faults, "/scheme/composition").detail.find("yoshida_4"), std::string::npos);
}

TEST(Decode, NamesBothSidesOfAnImpossiblePair) {
  const Fault fault = fault_at(bad(R"({"problem":"flow","scheme":{"id":"leapfrog"}})"), "/scheme/id");
  EXPECT_EQ(fault.detail, "leapfrog cannot run flow: it needs a separable Hamiltonian, and flow offers a vector field");
  EXPECT_EQ(fault.value, "\"leapfrog\"");
  EXPECT_EQ(fault.allowed, "runge_kutta_4");
  EXPECT_TRUE(bad(R"({"problem":"flow","scheme":"leapfrog"})").at("/scheme"));
}

struct Row {
  const char *text, *pointer;
};
class DecodeFault : public testing::TestWithParam<Row> {};
TEST_P(DecodeFault, IsFoundAtItsPlaceAndAlone) {
  const Faults faults = bad(GetParam().text);
  ASSERT_EQ(faults.list().size(), 1u) << GetParam().text;
  EXPECT_EQ(faults.list()[0].pointer, GetParam().pointer);
  EXPECT_FALSE(faults.list()[0].detail.empty());
}

#define SWING(rest) R"({"problem":"swing","scheme":"leapfrog",)" rest "}"
INSTANTIATE_TEST_SUITE_P(
    All, DecodeFault,
    testing::Values(
        Row{"[]", ""}, Row{"null", ""}, Row{R"({"scheme":"leapfrog"})", "/problem"},
        Row{R"({"problem":"swing"})", "/scheme"}, Row{R"({"problem":3,"scheme":"leapfrog"})", "/problem"},
        Row{R"({"problem":{},"scheme":"leapfrog"})", "/problem/id"},
        Row{R"({"problem":{"id":null},"scheme":"leapfrog"})", "/problem/id"},
        Row{R"({"problem":"swnig","scheme":"leapfrog"})", "/problem"},
        Row{R"({"problem":"swing","scheme":{"id":"leapfrog","step":null}})", "/scheme/step"},
        Row{R"({"problem":"swing","scheme":{"id":"leapfrog","step":"0.1*h"}})", "/scheme/step"},
        Row{R"({"problem":"swing","scheme":{"id":"leapfrog","composition":1}})", "/scheme/composition"},
        Row{R"({"problem":"swing","scheme":{"id":"own_clock","keep":1}})", "/scheme/keep"},
        Row{R"({"problem":"swing","scheme":{"id":"own_clock","stages":9}})", "/scheme/stages"},
        Row{R"({"problem":"swing","scheme":{"id":"own_clock","stages":1.5}})", "/scheme/stages"},
        Row{R"({"problem":"swing","scheme":{"id":"own_clock","preset":3}})", "/scheme/preset"},
        Row{R"({"problem":"swing","scheme":{"id":"own_clock","preset":"none"},"until":{"steps":4}})", "/scheme/preset"},
        Row{R"({"problem":"swing","scheme":"leapfrog","scheme":"leapfrog"})", "/scheme"},
        Row{R"({"problem":{"id":"swing","mass":1,"mass":1},"scheme":"leapfrog"})", "/problem/mass"},
        Row{SWING(R"("initial":[1])"), "/initial"}, Row{SWING(R"("initial":{"q":1e999})"), "/initial/q"},
        Row{SWING(R"("initial":{"t":1e300})"), "/until/t"}, Row{SWING(R"("until":true)"), "/until"},
        Row{SWING(R"("until":-1)"), "/until"}, Row{SWING(R"("until":{})"), "/until"},
        Row{SWING(R"("until":{"t":1,"steps":1})"), "/until"}, Row{SWING(R"("until":{"t":0})"), "/until/t"},
        Row{SWING(R"("until":{"t":1e300})"), "/until/t"}, Row{SWING(R"("until":{"steps":0})"), "/until/steps"},
        Row{SWING(R"("until":{"steps":1e300})"), "/until/steps"},
        Row{SWING(R"("until":{"steps":2.5})"), "/until/steps"}, Row{SWING(R"("record":{})"), "/record"},
        Row{SWING(R"("record":{"every":1,"samples":5})"), "/record"},
        Row{SWING(R"("record":{"every":-1})"), "/record/every"},
        Row{SWING(R"("until":{"steps":20000},"record":{"every":1})"), "/record/every"},
        Row{SWING(R"("record":{"samples":1})"), "/record/samples"},
        Row{SWING(R"("record":{"samples":10001})"), "/record/samples"},
        Row{SWING(R"("record":{"times":[]})"), "/record/times"}, Row{SWING(R"("record":{"times":3})"), "/record/times"},
        Row{SWING(R"("record":{"times":[1,3,2]})"), "/record/times/2"},
        Row{SWING(R"("record":{"times":[1,1]})"), "/record/times/1"},
        Row{SWING(R"("record":{"times":[-1,1]})"), "/record/times/0"},
        Row{SWING(R"("record":{"times":[1,20.5]})"), "/record/times/1"}, Row{SWING(R"("columns":[])"), "/columns"},
        Row{SWING(R"("columns":"t")"), "/columns"}, Row{SWING(R"("columns":["q","q"])"), "/columns/1"},
        Row{SWING(R"("diagnostics":["error","error"])"), "/diagnostics/1"},
        Row{SWING(R"("diagnostics":["moments"])"), "/diagnostics/0"}, Row{SWING(R"("limits":5)"), "/limits"},
        Row{SWING(R"("limits":{"seconds":0})"), "/limits/seconds"},
        Row{SWING(R"("limits":{"steps":1e18})"), "/limits/steps"}));

TEST(Decode, AcceptsTheEdges) {
  good(SWING(R"("record":{"times":[0,20]})"));
  good(SWING(R"("diagnostics":[])"));
  good(SWING(R"("record":{"every":0})"));
  good(SWING(R"("limits":{"seconds":60,"steps":1000000,"samples":10000})"));
  good(R"({"problem":{"id":"swing","mass":1e3,"level":0},"scheme":{"id":"leapfrog","step":1e3}})");
}

// Warnings do not depend on what is asked for.
TEST(Decode, EveryRunHasAControlRun) {
  EXPECT_TRUE(good(SWING(R"("diagnostics":[])")).control);
  EXPECT_TRUE(good(SWING(R"("diagnostics":["energy"])")).control);
  EXPECT_TRUE(good(SWING(R"("record":{"every":0})")).control);
}

TEST(Decode, BoundsWhatItSays) {
  std::string text = R"({"problem":"swing","scheme":"leapfrog","columns":[)";
  for (int i = 0; i < 10'000; ++i) text += i == 0 ? "\"x\"" : ",\"" + std::string(50, 'x') + "\"";
  const Faults faults = bad(text + "]}");
  EXPECT_EQ(faults.list().size(), Faults::most);
}

}  // namespace
}  // namespace least::server
