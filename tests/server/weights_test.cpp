// A composition given by its weights, in requests, answers, studies and cards, over real sockets.
#include <gtest/gtest.h>

#include "core/composition.hpp"
#include "server/decode/json_parse.hpp"
#include "tests/server/client.hpp"
#include "tests/server/faults.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

using WeightsHttp = Serving;

Json weighted(const char* scheme, const Json& composition) {
  return {{"problem", "damped_oscillator"},
          {"scheme", {{"id", scheme}, {"composition", composition}}},
          {"until", {{"t", 20}}}};
}
std::vector<double> weights_of_kahan_li_6() {
  const auto& known = Weights<double>::of(Composition::kahan_li_6);
  return {known.gamma.begin(), known.gamma.begin() + known.stages};
}
/// fault_of_weights() returns the only fault of such a request.
Json fault_of_weights(int port, const Json& composition, const char* scheme = "contact_leapfrog") {
  return only_fault(ask(port, post("/v1/simulate", weighted(scheme, composition).dump())));
}

TEST_F(WeightsHttp, StandForAComposition) {
  const auto answer = [&](const Json& request) {
    return Json::parse(ask(port(), post("/v1/simulate", request.dump())).body);
  };
  for (const char* scheme : {"contact_leapfrog", "contact_splitting"}) {
    const Json own = answer(weighted(scheme, {{"weights", weights_of_kahan_li_6()}}));
    EXPECT_EQ(own["scheme"]["composition"], (Json{{"weights", weights_of_kahan_li_6()}, {"order", 6}})) << scheme;
    EXPECT_EQ(own["trajectory"], answer(weighted(scheme, "kahan_li_6"))["trajectory"]) << scheme;
    Json sent_back;
    for (const char* key : {"problem", "initial", "scheme", "until", "record", "columns", "limits", "norm"})
      sent_back[key] = own.at(key);
    Json again = answer(sent_back), first = own;
    again.erase("cost");
    first.erase("cost");
    EXPECT_EQ(again, first) << scheme << ": the echo is a request";
  }
}

TEST_F(WeightsHttp, AreRefusedAtTheirPlace) {
  EXPECT_TRUE(says(fault_of_weights(port(), {{"weights", {0.6, 0.4}}}), "symmetric: weight 1 is 0.6"));
  const auto both = fault_of_weights(port(), {{"weights", {0.5, 0.6}}});
  EXPECT_TRUE(says(both, "must be symmetric: weight 1 is 0.5") && says(both, "must add up to 1")) << both;
  EXPECT_TRUE(says(fault_of_weights(port(), {{"weights", {0.3, 0.3}}}), "add up to 1 - 0.4"));
  for (const Json& list : {Json::array(), Json(std::vector<double>(100, 0.01))}) {
    const Json fault = fault_of_weights(port(), {{"weights", list}});
    EXPECT_EQ(fault["pointer"], "/scheme/composition/weights");
    EXPECT_TRUE(says(fault, "1 to 35"));
    EXPECT_EQ(fault["allowed"], "{\"weights\": [w1, …, wn]}, symmetric, of sum 1");
  }
  EXPECT_EQ(fault_of_weights(port(), {{"weights", {0.5, "x"}}})["pointer"], "/scheme/composition/weights/1");
  EXPECT_EQ(fault_of_weights(port(), {{"weights", {0.5, -101, 0.5}}})["allowed"], "[-100, 100]");
  EXPECT_EQ(fault_of_weights(port(), {{"weights", 1}})["pointer"], "/scheme/composition/weights");
  EXPECT_EQ(fault_of_weights(port(), Json::object())["pointer"], "/scheme/composition/weights");
  EXPECT_EQ(fault_of_weights(port(), {{"weight", 1}, {"weights", {1}}})["pointer"], "/scheme/composition/weight");
  for (const Json& no_composition : {Json(1), Json("kahan_li_9")}) {
    const Json fault = fault_of_weights(port(), no_composition);
    EXPECT_EQ(fault["pointer"], "/scheme/composition");
    EXPECT_TRUE(fault["allowed"].get<std::string>().ends_with(" or {\"weights\": [w1, …, wn]}, symmetric, of sum 1"))
        << fault;
  }
  EXPECT_EQ(fault_of_weights(port(), {{"weights", {1}}}, "contact_gauss")["pointer"], "/scheme/composition");
  const Json order = fault_of_weights(port(), {{"weights", {0.5, 0.5}}, {"order", 4}});
  EXPECT_EQ(order["pointer"], "/scheme/composition/order");
  EXPECT_EQ(order["allowed"], "2");
}

TEST_F(WeightsHttp, AreMeasuredByTheirOrder) {
  const Json request{{"problem", "harmonic_oscillator"},
                     {"until", {{"t", 10}}},
                     {"schemes", {{{"id", "leapfrog"}, {"composition", {{"weights", weights_of_kahan_li_6()}}}}}}};
  const Json study = Json::parse(ask(port(), post("/v1/work-precision", request.dump())).body);
  const Json& curve = study["curves"][0];
  EXPECT_EQ(curve["expected_order"], 6) << study;
  EXPECT_NEAR(curve["observed_order"].get<double>(), 6, 0.2);
  EXPECT_EQ(curve["scheme"]["composition"]["order"], 6);
}

TEST_F(WeightsHttp, AreOfferedByTheCards) {
  const auto takes = [&](const char* scheme, const char* parameter) {
    const Json card = Json::parse(ask(port(), get(std::string("/v1/schemes/") + scheme)).body);
    for (const Json& known : card["parameters"])
      if (known["name"] == parameter) return known.contains("weights") && known["weights"] == true;
    ADD_FAILURE() << card;
    return false;
  };
  EXPECT_TRUE(takes("leapfrog", "composition"));
  EXPECT_FALSE(takes("leapfrog", "step"));
  EXPECT_FALSE(takes("contact_splitting", "splitting"));
}

}  // namespace
}  // namespace least::server::test
