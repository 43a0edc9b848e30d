// The starts of the members of an ensemble, over HTTP.
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "tests/server/client.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

using MembersHttp = Serving;

// Where the start is given in velocities the members have these in common, and each member the momenta that follow with
// its own parameters and positions, as single runs do; where momenta are given, or vary, the members have those in
// common.
TEST_F(MembersHttp, MembersOfAStartInVelocitiesAreTheirRuns) {
  const Json problem = Json::parse(R"~({"id":"custom","variables":["x","y"],"parameters":{"m":2,"b":0.7},
      "lagrangian":"m*(vx^2+vy^2*(1+x^2))/2 + b*x*vy - x^2/2 - y^2"})~");
  const Json start{{"x", 0.3}, {"y", 0.1}, {"vx", 1}, {"vy", 0.4}};
  const Json scheme{{"id", "runge_kutta_4"}, {"step", 0.05}};
  const auto ask_for = [&](const char* path, const Json& request) {
    const Reply reply = ask(port(), post(path, request.dump()));
    EXPECT_EQ(reply.status, 200) << reply.body;
    return Json::parse(reply.body);
  };
  const auto ensemble = [&](const Json& vary) {
    return ask_for("/v1/ensemble", {{"problem", problem},
                                    {"initial", start},
                                    {"scheme", scheme},
                                    {"until", 1},
                                    {"members", vary.contains("vary") ? vary : Json{{"vary", vary}}},
                                    {"keep", {"final"}},
                                    {"columns", {"x", "y", "px", "py"}}});
  };
  const auto run = [&](const std::string& place, double value) {
    Json request{
        {"problem", problem}, {"initial", start}, {"scheme", scheme}, {"until", 1}, {"record", {{"every", 0}}}};
    request[Json::json_pointer(place)] = value;
    return ask_for("/v1/simulate", request)["final"];
  };
  const std::pair<const char*, const char*> varied[] = {{"/problem/m", "/problem/m"},
                                                        {"/problem/b", "/problem/b"},
                                                        {"/initial/x", "/initial/x"},
                                                        {"/initial/vy", "/initial/vy"}};
  for (const auto& [pointer, place] : varied) {
    const Json made = ensemble({{pointer, {{"values", {0.5, 1.0, 4.0}}}}});
    EXPECT_EQ(made["members"]["holds"], "velocities");
    for (std::size_t k = 0; k < 3; ++k) {
      const Json alone = run(place, std::vector{0.5, 1.0, 4.0}[k]);
      for (const char* column : {"x", "y", "px", "py"})
        EXPECT_EQ(made["final"][column][k], alone[column]) << pointer << ' ' << k << column;
    }
    // The answer's echo is a request of the same members, whose start is in momenta.
    Json again;
    for (const char* key : {"problem", "initial", "scheme", "until", "limits", "members", "range", "columns", "keep"})
      again[key] = made[key];
    const Json once_more = ask_for("/v1/ensemble", again);
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_NEAR(once_more["final"]["px"][k], made["final"]["px"][k].get<double>(), 1e-13) << pointer;
  }
  const Json momenta = ensemble({{"vary", {{"/problem/m", {{"values", {1, 2}}}}}}, {"holds", "momenta"}});
  EXPECT_EQ(momenta["final"]["px"][1], run("/problem/m", 2)["px"]);
  EXPECT_NE(momenta["final"]["x"][0], run("/problem/m", 1)["x"]);
  EXPECT_EQ(ensemble({{"/initial/px", {{"values", {1, 2}}}}})["members"]["holds"], "momenta");
  const Json both{{"vary", {{"/initial/px", {{"values", {1, 2}}}}}}, {"holds", "velocities"}};
  const Reply refused = ask(
      port(),
      post("/v1/ensemble",
           Json{{"problem", problem}, {"initial", start}, {"scheme", scheme}, {"until", 1}, {"members", both}}.dump()));
  EXPECT_EQ(refused.status, 422);
  EXPECT_NE(refused.body.find("vary vx"), std::string::npos) << refused.body;
}

// Pointers to elements are those of sensitivities: /initial/x/1 is /initial/x[2].
TEST_F(MembersHttp, VaryWhatIsCountedByEitherPointer) {
  const auto made = [&](const std::string& start, const std::string& parameter) {
    const Json request{{"problem", Json::parse(R"~({"id":"custom","variables":["x[2]"],"parameters":{"m":[1,2]},
                          "potential":"sum(i=1..2, m[i]*x[i]^2/2)"})~")},
                       {"scheme", "leapfrog"},
                       {"until", 1},
                       {"members", {{"vary", {{start, {{"values", {1, 2}}}}, {parameter, {{"values", {3, 4}}}}}}}},
                       {"keep", {"final"}}};
    const Reply reply = ask(port(), post("/v1/ensemble", request.dump()));
    EXPECT_EQ(reply.status, 200) << reply.body;
    return Json::parse(reply.body)["final"];
  };
  EXPECT_EQ(made("/initial/x/1", "/problem/m/0"), made("/initial/x[2]", "/problem/m[1]"));
  EXPECT_EQ(made("/initial/vx/0", "/problem/parameters/m/1"), made("/initial/vx[1]", "/problem/m[2]"));
  const Json twice{
      {"problem", {{"id", "custom"}, {"variables", {"x[2]"}}, {"potential", "x[1]^2+x[2]^2"}}},
      {"scheme", "leapfrog"},
      {"members", {{"vary", {{"/initial/x/1", {{"values", {1, 2}}}}, {"/initial/x[2]", {{"values", {1}}}}}}}}};
  EXPECT_EQ(ask(port(), post("/v1/ensemble", twice.dump())).status, 422);
}

// At the pole of polar coordinates momenta do not determine velocities; the members begin elsewhere.
TEST_F(MembersHttp, MembersBeginWhereTheCommonStartCannot) {
  const Json request = Json::parse(R"~({"problem":{"id":"custom","variables":["r","a"],
      "lagrangian":"(vr^2+r^2*va^2)/2-r^2/2"},"initial":{"va":0.5},"until":1,"scheme":"runge_kutta_4",
      "members":{"vary":{"/initial/r":{"values":[1,2]}}},"keep":["final"],"columns":["pa"]})~");
  const Reply reply = ask(port(), post("/v1/ensemble", request.dump()));
  ASSERT_EQ(reply.status, 200) << reply.body;
  const Json made = Json::parse(reply.body);
  EXPECT_EQ(made["completed"], 2) << reply.body;
  EXPECT_NEAR(made["final"]["pa"][1], 4 * 0.5, 1e-12) << "r² va";
}

// Where the common start cannot be read, the variations are not checked against it.
TEST_F(MembersHttp, AFaultInWhatTheyHoldIsTheOnlyOne) {
  const Reply reply = ask(port(), post("/v1/ensemble", R"~({"problem":{"id":"custom","variables":["x"],
      "potential":"x^2/2"},"scheme":"leapfrog","until":1,
      "members":{"vary":{"/initial/vx":{"values":[1,2]}},"holds":5}})~"));
  EXPECT_EQ(reply.status, 422);
  const Json errors = Json::parse(reply.body)["errors"];
  ASSERT_EQ(errors.size(), 1U) << reply.body;
  EXPECT_EQ(errors[0]["pointer"], "/members/holds");
}

}  // namespace
}  // namespace least::server::test
