// Pictures of a scene as text: views and bodies are checked and echoed, and do not change the motion.
#include <gtest/gtest.h>

#include "server/decode/json_parse.hpp"
#include "tests/server/client.hpp"
#include "tests/server/faults.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

using Pictures = Serving;

Json pendulum() {
  return Json::parse(R"~({"id":"custom","variables":["theta"],"parameters":{"l":2},
    "lagrangian":"l^2*vtheta^2/2 + l*cos(theta)","note":"swings",
    "views":[["theta","ptheta"],["t","l*sin(theta)"]],
    "bodies":[{"at":["l*sin(theta)","-l*cos(theta)"],"linked":["pivot"]},{"at":[0,"-l"],"linked":[0],"kind":"sun"}]})~");
}
Reply card_of(int port, const Json& problem) {
  return ask(port, post("/v1/problems", Json{{"problem", problem}}.dump()));
}
Json run_of(int port, const Json& problem) {
  const Json request{{"problem", problem}, {"initial", {{"theta", 1}}}, {"scheme", "leapfrog"}, {"until", 3}};
  const Reply reply = ask(port, post("/v1/simulate", request.dump()));
  EXPECT_EQ(reply.status, 200) << reply.body;
  return Json::parse(reply.body);
}

TEST_F(Pictures, StandInTheCardAndInTheEchoWithTheirDefaults) {
  Json bodies = pendulum()["bodies"];
  bodies[0]["kind"] = "bob";
  bodies[1]["at"] = {"0", "-l"};
  const Json card = Json::parse(card_of(port(), pendulum()).body);
  EXPECT_EQ(card["views"], pendulum()["views"]);
  EXPECT_EQ(card["bodies"], bodies);
  const Json echo = run_of(port(), pendulum())["problem"];
  EXPECT_EQ(echo["views"], pendulum()["views"]);
  EXPECT_EQ(echo["bodies"], bodies);
  EXPECT_EQ(echo["note"], "swings");
  EXPECT_EQ(run_of(port(), echo)["problem"], echo) << "sent back, it is the same";
}

// The example of the contract: one body, linked to body 0, which is itself, and to the pivot.
TEST_F(Pictures, MayLinkABodyToItself) {
  Json problem = pendulum();
  problem["bodies"] = Json::parse(R"~([{"at":["theta","t"],"linked":[0,"pivot"],"kind":"bob"}])~");
  EXPECT_EQ(run_of(port(), problem)["problem"]["bodies"], problem["bodies"]);
}

TEST_F(Pictures, ChangeNothingThatMoves) {
  Json plain = pendulum();
  for (const char* key : {"views", "bodies", "note"}) plain.erase(key);
  const Json drawn = run_of(port(), pendulum()), bare = run_of(port(), plain);
  EXPECT_EQ(drawn["trajectory"], bare["trajectory"]);
  EXPECT_FALSE(bare["problem"].contains("views"));
  EXPECT_FALSE(bare["problem"].contains("note"));
  EXPECT_FALSE(Json::parse(card_of(port(), plain).body).contains("bodies"));
}

TEST_F(Pictures, KnowAllOfAKind) {
  const Json many = Json::parse(R"~({"id":"custom","variables":["x[3]","y[3]"],
    "potential":"sum(i=1..3, x[i]^2 + y[i]^2)","views":[["x[*]","y[*]"]],
    "bodies":[{"at":["x[1]","y[1]"]},{"at":["x[2]","sum(i=1..3, y[i])/3"]}]})~");
  const Json card = Json::parse(card_of(port(), many).body);
  EXPECT_EQ(card["views"], many["views"]) << card;
  Json other = many;
  other["views"][0][1] = "z[*]";
  EXPECT_EQ(only_fault(card_of(port(), other))["pointer"], "/problem/views/0/1");
  other = many;
  other["bodies"][1]["at"][0] = "x[*]";
  EXPECT_EQ(only_fault(card_of(port(), other))["pointer"], "/problem/bodies/1/at/0") << "a body is at one place";
}

TEST_F(Pictures, FaultsNameTheirPlace) {
  const struct {
    const char *key, *value, *pointer, *says, *allowed;
  } rows[] = {
      {"views", R"~({"x":1})~", "/problem/views", "must be a list", "8 at most"},
      {"views", R"~([["theta"]])~", "/problem/views/0", "must be a place", "two or three"},
      {"views", R"~([["theta","ptheta","t","s"]])~", "/problem/views/0", "must be a place", "two or three"},
      {"views", R"~([["theta",null]])~", "/problem/views/0/1", "column or an expression", ""},
      {"views", R"~([["theta","pteta"]])~", "/problem/views/0/1", "did you mean \"ptheta\"", ""},
      {"views", R"~([["theta","l*sin(theta"]])~", "/problem/views/0/1", "", ""},
      {"bodies", R"~("theta")~", "/problem/bodies", "must be a list", "256 at most"},
      {"bodies", R"~([{"linked":["pivot"]}])~", "/problem/bodies/0/at", "is required", "two or three"},
      {"bodies", R"~([{"at":["phi","theta"]}])~", "/problem/bodies/0/at/0", "unknown column or name phi", ""},
      {"bodies", R"~([{"at":["theta","t"],"kind":"moon"}])~", "/problem/bodies/0/kind", "unknown kind",
       "bob, planet, sun"},
      {"bodies", R"~([{"at":["theta","t"],"linked":[1]}])~", "/problem/bodies/0/linked/0", "no such body", "0 to 0"},
      {"bodies", R"~([{"at":["theta","t"],"linked":[-1]}])~", "/problem/bodies/0/linked/0", "no such body", "pivot"},
      {"bodies", R"~([{"at":["theta","t"],"linked":"pivot"}])~", "/problem/bodies/0/linked", "must be a list", ""},
      {"bodies", R"~([{"at":["theta","t"],"weight":1}])~", "/problem/bodies/0/weight", "", "kind"},
      {"bodies", R"~([{"at":["theta","t"]},{"at":["theta","t","l"]}])~", "/problem/bodies/1/at", "as many", ""},
      {"note", "5", "/problem/note", "must be a text", "1000"},
  };
  for (const auto& row : rows) {
    Json problem = pendulum();
    problem[row.key] = Json::parse(row.value);
    const Json fault = only_fault(card_of(port(), problem));
    EXPECT_EQ(fault["pointer"], row.pointer) << row.value;
    EXPECT_TRUE(says(fault, row.says)) << fault;
    EXPECT_NE(fault.value("allowed", "").find(row.allowed), std::string::npos) << fault;
  }
  Json problem = pendulum();
  problem["views"][1][1] = "l*sin(teta)";
  EXPECT_EQ(only_fault(card_of(port(), problem))["position"], 6) << "where in the expression";
}

}  // namespace
}  // namespace least::server::test
