#include "server/encode/catalogue_json.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "least_version.hpp"
#include "tests/server/cards.hpp"

namespace least::server {
namespace {

using Json = nlohmann::ordered_json;

TEST(Catalogue, SaysAllThatAFormNeeds) {
  const CatalogueText catalogue = describe(test::cards());
  const Json json = Json::parse(catalogue.all);
  EXPECT_EQ(json["version"], version);
  const Json& swing = json["problems"][0];
  EXPECT_EQ(swing, Json::parse(catalogue.problems.at("swing")));
  for (const char* key : {"id", "title", "summary", "formula", "variables", "parameters", "until", "suggested",
                          "presets", "invariants", "columns", "diagnostics", "schemes", "references"}) {
    EXPECT_TRUE(swing.contains(key)) << key;
  }
  EXPECT_EQ(swing["variables"][0]["default"], 1);
  EXPECT_EQ(swing["parameters"][0]["minimum"], 0);
  EXPECT_EQ(swing["parameters"][0]["exclusive_minimum"], true);
  EXPECT_EQ(swing["parameters"][1]["type"], "integer");
  EXPECT_EQ(swing["schemes"], Json::parse(R"(["leapfrog","runge_kutta_4","own_clock","auto"])"));
  EXPECT_EQ(swing["presets"][0]["initial"]["t"], 5);

  const Json& leapfrog = json["schemes"][0];
  for (const char* key : {"id", "title", "summary", "order", "implicit", "symmetric", "structure", "parameters",
                          "recommended", "presets", "good_for", "fails_when", "references"}) {
    EXPECT_TRUE(leapfrog.contains(key)) << key;
  }
  EXPECT_EQ(leapfrog["order"]["yoshida_4"], 4);
  EXPECT_EQ(leapfrog["parameters"][0]["suggested"], "step");
  EXPECT_EQ(leapfrog["parameters"][1]["choices"], Json::parse(R"(["none","yoshida_4"])"));
  EXPECT_EQ(leapfrog["parameters"][1]["default"], "none");
  EXPECT_EQ(json["schemes"][1]["order"], 4);
  EXPECT_EQ(leapfrog["presets"], Json::array());
  EXPECT_EQ(leapfrog["own_clock"], false);
  const Json& clock = json["schemes"][2];
  EXPECT_EQ(clock["parameters"][0]["default"], true);
  EXPECT_EQ(clock["parameters"][1]["nullable"], true);
  EXPECT_FALSE(clock["parameters"][1].contains("word"));
  EXPECT_EQ(clock["parameters"][3]["word"], "energy");
  EXPECT_EQ(clock["own_clock"], true);
  EXPECT_EQ(clock["presets"], Json::parse(R"([{"name":"paper","doc":"As published.",
    "parameters":{"critical":null,"stages":4}},{"name":"kepler","doc":"Exact orbits.",
    "parameters":{"keep":false,"kappa":"energy"}}])"));
  const Json& automatic = json["schemes"][3];
  EXPECT_EQ(automatic, Json::parse(catalogue.schemes.at("auto")));
  EXPECT_EQ(automatic["order"], nullptr);
  EXPECT_EQ(automatic["parameters"][0]["name"], "accuracy");
  EXPECT_EQ(automatic["parameters"][0]["default"], 1e-6);
  EXPECT_EQ(automatic["parameters"][2]["type"], "list");
  EXPECT_EQ(automatic["parameters"][2]["choices"], Json::parse(R"(["energy","structure","momenta"])"));
  EXPECT_EQ(swing["suggested"], Json::parse(R"({"step":0.1,"critical":0.5})"));
  EXPECT_EQ(swing["presets"][1]["suggested"], Json::parse(R"({"critical":0.25})"));
}

}  // namespace
}  // namespace least::server
