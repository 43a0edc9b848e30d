// Scenes as text that cannot be read: what is refused and where; all faults are named.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>

#include "tests/server/client.hpp"
#include "tests/server/faults.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

using CustomFaults = Serving;

TEST_F(CustomFaults, AllFaultsAreToldAtOnce) {
  const Json document =
      Json::parse(ask(port(), post("/v1/problems", R"({"problem":{"id":"custom","variables":["x"],"zzz":1,
          "potential":"foo*x","damping":"bar","invariants":{"L":"baz"}}})"))
                      .body);
  std::vector<std::string> pointers;
  for (const Json& error : document["errors"]) pointers.push_back(error["pointer"]);
  std::ranges::sort(pointers);
  EXPECT_EQ(pointers, (std::vector<std::string>{"/problem/damping", "/problem/invariants/L", "/problem/potential",
                                                "/problem/zzz"}))
      << document;
}

// A fault hides no other: neither a member that is not text, nor a definition, which is expanded in other texts first.
TEST_F(CustomFaults, NoneHidesOthers) {
  const struct {
    const char* problem;
    std::vector<std::string> pointers;
  } rows[] = {
      {R"~("variables":["x"],"definitions":{"r":"sqrt(x^2+","k":"q+1"},"masses":{"x":"mm"},"potential":"r+k+y")~",
       {"/problem/definitions/k", "/problem/definitions/r", "/problem/masses/x", "/problem/potential"}},
      {R"~("variables":["x"],"definitions":{"1r":"x"},"masses":{"x":"mm"},"potential":"x^2")~",
       {"/problem/definitions/1r", "/problem/masses/x"}},
      {R"~("variables":["x"],"definitions":{"r":true},"masses":{"x":[1]},"damping":"z","potential":"r+y")~",
       {"/problem/damping", "/problem/definitions/r", "/problem/masses/x", "/problem/potential"}},
      {R"~("variables":["x[2]"],"definitions":{"d(i)":"x[i]-x[i+1]"},"masses":{"x":"mm"},"potential":"sum(i=1..2,d(i))")~",
       {"/problem/definitions/d(i)", "/problem/masses/x"}},
  };
  for (const auto& row : rows) {
    const auto reply =
        ask(port(), post("/v1/problems", R"({"problem":{"id":"custom",)" + std::string(row.problem) + "}}"));
    ASSERT_EQ(reply.status, 422) << row.problem << reply.body;
    const Json document = Json::parse(reply.body);
    std::vector<std::string> pointers;
    for (const Json& error : document["errors"]) pointers.push_back(error["pointer"]);
    std::ranges::sort(pointers);
    EXPECT_EQ(pointers, row.pointers) << document;
  }
}

// Pointers of all faults of a reply, in their order.
std::vector<std::string> pointers_of(const Reply& reply) {
  EXPECT_EQ(reply.status, 422) << reply.body;
  std::vector<std::string> pointers;
  const Json document = Json::parse(reply.body);
  for (const Json& error : document["errors"]) pointers.push_back(error["pointer"]);
  std::ranges::sort(pointers);
  return pointers;
}

// A fault in the scene hides no fault in the rest of the request, which is read with the names that the scene declares
// nevertheless; and no fault is told that vanishes when the scene is corrected.
// A definition that the mechanics do not use is read by columns and events, which know no other names.
TEST_F(CustomFaults, NamesInUnusedDefinitionsAreKnown) {
  const auto reply_to = [&](const std::string& definitions) {
    return ask(port(), post("/v1/problems", R"({"problem":{"id":"custom","variables":["x[3]","y"],"potential":"y^2/2+w",
        "parameters":{"m":[1,2,3],"k":2},"definitions":{"w":"k*x[1]^2",)" +
                                                definitions + "}}}"));
  };
  for (const char* good : {R"~("r":"vx[2]*py*t*s*energy*pi+1e5*m[3]+2.5e-3*k")~",
                           R"~("d(i,j)":"sum(l = i..j, if(l == 2 and not y < 0, w, x[l]))")~",
                           R"~("e":"prod(i=1..3, m[mod(i,3)+1])","f(i)":"e*abs(x[i])")~"})
    EXPECT_EQ(reply_to(good).status, 200) << good << reply_to(good).body;
  const struct {
    const char* definitions;
    const char* pointer;
    int position;
    const char* name;
  } rows[] = {{R"~("r":"sqrt(y^2+foo^2)")~", "/problem/definitions/r", 9, "foo"},
              {R"~("d(i)":"x[i]-x[j]")~", "/problem/definitions/d(i)", 7, "j"},
              {R"~("a":"bar","b":"a+1")~", "/problem/definitions/a", 0, "bar"},
              {R"~("g":"1e5*vz")~", "/problem/definitions/g", 4, "vz"}};
  for (const auto& [definitions, pointer, position, name] : rows) {
    const Json fault = only_fault(reply_to(definitions));
    EXPECT_EQ(fault["pointer"], pointer) << fault;
    EXPECT_EQ(fault["position"], position) << fault;
    EXPECT_EQ(fault["detail"].get<std::string>().find("nobody knows the name " + std::string(name)), 0U) << fault;
    EXPECT_NE(fault["allowed"].get<std::string>().find("x, vx, px, y, vy, py, k, m, w"), std::string::npos) << fault;
  }
  std::string many;
  for (int i = 0; i < 4000; ++i) many += (i > 0 ? ",\"a" : "\"a") + std::to_string(i) + "\":\"zz\"";
  const Json document = Json::parse(reply_to(many).body);
  EXPECT_EQ(document["errors"].size(), 100U);
}

TEST_F(CustomFaults, OfASceneHideNothingOfTheRequest) {
  const struct {
    const char *path, *request;
    std::vector<std::string> pointers;
  } rows[] = {
      {"/v1/simulate",
       R"~({"problem":{"id":"custom","variables":["x"],"parameters":{"k":"foo"},"potential":"k*x^2/2"},
          "initial":{"x":"1/0","px":true,"y":1},"scheme":{"id":"leapfrog","step":-1},"until":"pie",
          "columns":["x","zz"],"record":{"every":-1},"diagnostics":["enrgy"],"norm":"q","limits":{"seconds":-1},
          "events":[{"name":"e","expression":"x+"}],"section":{"period":-1},
          "sensitivities":{"by":["/initial/zz","/problem/k"],"order":3,"of":"me","at":"x"}})~",
       {"/columns/1", "/diagnostics/0", "/events/0/expression", "/initial/px", "/initial/x", "/initial/y",
        "/limits/seconds", "/norm", "/problem/parameters/k", "/record/every", "/scheme/step", "/section/period",
        "/sensitivities/at", "/sensitivities/by/0", "/sensitivities/of", "/sensitivities/order", "/until"}},
      {"/v1/simulate",
       R"~({"problem":{"id":"custom","variables":["x"],"lagrangian":"vx^2/2 - x^2/2 - s*foo"},
          "initial":{"x":1,"vx":"q"},"scheme":"contact_splitting","until":1,"columns":["x","s","zz"],
          "diagnostics":["decay","energy"]})~",
       {"/columns/2", "/initial/vx", "/problem/lagrangian"}},
      {"/v1/simulate",
       R"~({"problem":{"id":"custom","variables":["x"],"potential":"x^2/2","damping":"0.1*foo"},
          "scheme":"contact_splitting","until":1,"columns":["s","zz"],"diagnostics":["decay"]})~",
       {"/columns/1", "/problem/damping"}},
      {"/v1/simulate",
       R"~({"problem":{"id":"custom","variables":["x"],"potential":7},"initial":{"x":1,"z":2},
          "scheme":"kepler_splitting","until":1})~",
       {"/initial/z", "/problem/potential"}},
      {"/v1/simulate",
       R"~({"problem":{"id":"custom","variables":["x","v"],"equations":{"x":"v+","v":"-x"}},
          "initial":{"z":2},"scheme":"taylor","until":1,"columns":["v","w"]})~",
       {"/columns/1", "/initial/z", "/problem/equations/x"}},
      {"/v1/simulate",
       R"~({"problem":{"id":"custom","variables":["x[n]"],"parameters":{"n":"many"},
          "hamiltonian":"sum(i=1..n,px[i]^2/2)"},"initial":{"x":[1,2]},"scheme":"leapfrog","until":1})~",
       {"/problem/parameters/n"}},
      {"/v1/simulate",
       R"~({"problem":{"id":"custom","variables":["x[3]","y[3]"],"parameters":{"m":[1,"a",3]},
          "hamiltonian":"sum(i=1..3,(px[i]^2+py[i]^2)/2/mm[i])","views":[["x[1]","nope"]],
          "bodies":[{"at":[true,"zz"],"linked":[9]},{"at":["x[1]","qq"],"kind":"star"}]},
          "initial":{"x":[1,2],"px":[1,1,"a+"]},"scheme":"leapfrog","until":1})~",
       {"/initial/px/2", "/initial/x", "/problem/bodies/0/at/0", "/problem/bodies/0/at/1", "/problem/bodies/0/linked/0",
        "/problem/bodies/1/at/1", "/problem/bodies/1/kind", "/problem/hamiltonian", "/problem/parameters/m/1",
        "/problem/views/0/1"}},
      {"/v1/ensemble",
       R"~({"problem":{"id":"custom","variables":["x"],"parameters":{"k":"foo"},"potential":"k*x^2/2"},
          "initial":{"px":"w"},"scheme":"leapfrog","until":1,"columns":["x","zz"],"keep":["fin"],"range":[0,-1],
          "members":{"count":-1,"seed":"a","vary":{"/initial/y":{"uniform":[0,1]},
                     "/initial/x":{"grid":["a",1,2.5]}}},
          "histograms":{"x":{"range":[1,"q"],"bins":0},"v":{"range":[2,1],"bins":"z","zz":1},"px":{"bins":0}}})~",
       {"/columns/1", "/histograms/px", "/histograms/px/bins", "/histograms/v/bins", "/histograms/v/range",
        "/histograms/v/zz", "/histograms/x/bins", "/histograms/x/range/1", "/initial/px", "/keep/0", "/members/count",
        "/members/seed", "/members/vary/~1initial~1x/grid/0", "/members/vary/~1initial~1x/grid/2",
        "/members/vary/~1initial~1y", "/problem/parameters/k", "/range/1"}},
      {"/v1/ensemble",
       R"~({"problem":"no_such","scheme":"leapfrog","until":1,"members":{"count":3},
          "histograms":{"x":{"range":[2,1],"bins":0}}})~",
       {"/histograms/x/bins", "/histograms/x/range", "/problem"}},
  };
  for (const auto& row : rows)
    EXPECT_EQ(pointers_of(ask(port(), post(row.path, row.request))), row.pointers) << row.request;
}

// The fault of a number given as text tells what is wrong with the text, and at which position.
TEST_F(CustomFaults, OfANumberAsTextSayWhatIsWrongWithIt) {
  const struct {
    const char *until, *says;
    int position;
  } rows[] = {{"1/0", "no finite number", 1},
              {"2*log(-1)", "no finite number", 2},
              {"3*foo", "must be a number: nobody knows the name foo", 2},
              {"2*(1+3", "never closed", 2}};
  for (const auto& row : rows) {
    const Json fault = only_fault(ask(port(), post("/v1/simulate", R"({"problem":{"id":"custom","variables":["x"],
        "potential":"x^2/2"},"scheme":"taylor","until":")" + std::string(row.until) +
                                                                       R"("})")));
    EXPECT_EQ(fault["pointer"], "/until");
    EXPECT_TRUE(says(fault, row.says)) << fault;
    EXPECT_EQ(fault.value("position", -1), row.position) << fault;
    EXPECT_EQ(fault["value"], row.until);
  }
}

// The number of variables of a kind is a parameter like any other: it may stand beside the id.
TEST_F(CustomFaults, SizesMayStandBesideTheId) {
  Json request = Json::parse(R"~({"problem":{"id":"custom","variables":["x[n]"],"parameters":{"n":2},"n":3,
      "potential":"sum(i=1..n, i*x[i]^2/2)"},"initial":{"x":[1,2,3]},"scheme":"leapfrog","until":1,
      "record":{"every":0},"diagnostics":[]})~");
  const Reply reply = ask(port(), post("/v1/simulate", request.dump()));
  ASSERT_EQ(reply.status, 200) << reply.body;
  const Json made = Json::parse(reply.body);
  EXPECT_EQ(made["final"].size(), 7U) << made["final"];
  request["problem"].erase("n");
  request["problem"]["parameters"]["n"] = 3;
  EXPECT_EQ(Json::parse(ask(port(), post("/v1/simulate", request.dump())).body)["final"], made["final"]);
  request["problem"] = made["problem"];
  EXPECT_EQ(Json::parse(ask(port(), post("/v1/simulate", request.dump())).body)["final"], made["final"]);
  request["problem"]["n"] = "many";
  const Reply refused = ask(port(), post("/v1/simulate", request.dump()));
  EXPECT_EQ(refused.status, 422);
  EXPECT_EQ(Json::parse(refused.body)["errors"][0]["pointer"], "/problem/n") << refused.body;
}

TEST_F(CustomFaults, NamesHaveTheLengthThatIsAllowed) {
  const std::string name(16, 'a');
  const auto reply = ask(port(), post("/v1/problems", R"({"problem":{"id":"custom","variables":[")" + name +
                                                          R"("],"parameters":{"angular_frequency":2},"lagrangian":"v)" +
                                                          name + "^2/2 - angular_frequency^2*" + name + R"(^2/2"}})"));
  EXPECT_EQ(reply.status, 200) << reply.body;
}

// Each bad input is refused at its place, soon.
TEST_F(CustomFaults, FaultsNameTheirPlace) {
  const std::string deep(101, '('), long_text(10'001, '1');
  const struct {
    std::string problem;
    const char* pointer;
    int position;  ///< −1: none
    const char* says;
  } rows[] = {
      {R"~("variables":["x"],"potential":"x^2 + 1/0")~", "/problem/potential", 7, "no finite number"},
      {R"~("variables":["x"],"potential":"sqrt(-1)*x")~", "/problem/potential", 0, "no finite number"},
      {R"~("variables":["x"],"potential":"x^2 + y")~", "/problem/potential", 6, "nobody knows the name y"},
      {R"~("variables":["x"],"parameters":{"omega":1},"potential":"omga*x")~", "/problem/potential", 0, "omega"},
      {R"~("variables":["x"],"definitions":{"r":"foo(y)+"},"potential":"x^2")~", "/problem/definitions/r", 0, "foo"},
      {R"~("variables":["x"],"definitions":{"r":"2*x","u":"r*(x"},"potential":"x^2")~", "/problem/definitions/u", 2,
       "never closed"},
      {R"~("variables":["x[0]"],"potential":"1")~", "/problem/variables/0", -1, "at least one element"},
      {R"~("variables":["x","x"],"potential":"x")~", "/problem/variables/1", -1, "already"},
      {R"~("variables":["x","vx"],"potential":"x")~", "/problem/variables/1", -1, "vx is a velocity already, of x"},
      {R"~("variables":["sin"],"potential":"sin")~", "/problem/variables/0", -1, "sin is a function already"},
      {R"~("variables":["not"],"potential":"x^2")~", "/problem/variables/0", -1, "not is a word of conditions already"},
      {R"~("variables":["x"],"parameters":{"t":1},"potential":"x")~", "/problem/parameters/t", -1, "already"},
      {R"~("variables":["x"],"parameters":{"potential":1},"potential":"x")~", "/problem/parameters/potential", -1,
       "key"},
      {R"~("variables":["x","v"],"equations":{"x":"v"})~", "/problem/equations/v", -1, "missing"},
      {R"~("variables":["x"],"equations":{"x":"1","y":"x"})~", "/problem/equations/y", -1, "no variable"},
      {R"~("variables":["x[3]"],"equations":{"x[i]":"1","x[2]":"x[1]"})~", "/problem/equations/x[2]", -1,
       "the rate of x[2] once more"},
      {R"~("variables":["x[3]"],"equations":{"x[2]":"x[1]","x[i]":"1"})~", "/problem/equations/x[i]", -1,
       "the rate of x[2] once more"},
      {R"~("variables":["x[1]"],"equations":{"x[i]":"1","x[j]":"2"})~", "/problem/equations/x[j]", -1,
       "the rate of x[1] once more"},
      {R"~("variables":["x[3]"],"potential":"0","masses":{"x":"1","x[2]":"5"})~", "/problem/masses/x[2]", -1,
       "the mass of x[2] once more"},
      {R"~("variables":["x[3]"],"potential":"0","masses":{"x[2]":"5","x":"1"})~", "/problem/masses/x", -1,
       "the mass of x[2] once more"},
      {R"~("variables":["x"],"potential":"0","masses":{"y":"1"})~", "/problem/masses/y", -1, "no variable"},
      {R"~("variables":["x"],"potential":"x^2","masses":{"x":0})~", "/problem/masses/x", -1, "positive"},
      {R"~("variables":["x"],"parameters":{"m":-1},"potential":"x^2","masses":{"x":"m"})~", "/problem/masses/x", -1,
       "positive"},
      {R"~("variables":["x"],"lagrangian":"-vx^2/2 - x^2")~", "/problem/lagrangian", -1, "mass of x is not positive"},
      {R"~("variables":["x","y"],"parameters":{"m":-1},"lagrangian":"(vx^2 + m*vy^2)/2 - x^2")~", "/problem/lagrangian",
       -1, "mass of y is not positive"},
      {R"~("variables":["x"],"parameters":{"m":-2},"hamiltonian":"px^2/(2*m) + x^2")~", "/problem/hamiltonian", -1,
       "mass of x is not positive"},
      {R"~("variables":["x"],"potential":"x^2","masses":{"x":"1 + x"})~", "/problem/masses/x", 4, "made of parameters"},
      {R"~("variables":["x"],"lagrangian":"-x^2")~", "/problem/lagrangian", -1, "not regular"},
      {R"~("variables":["x"],"lagrangian":"vx - x^2")~", "/problem/lagrangian", -1, "not regular"},
      {R"~("variables":["x","y"],"lagrangian":"vx^2/2 - x^2")~", "/problem/lagrangian", -1, "vy"},
      {R"~("variables":["x"],"potential":"x^2 + vx")~", "/problem/potential", 6, "velocity"},
      {R"~("variables":["x"],"potential":"x^2 + px")~", "/problem/potential", 6, "momentum"},
      {R"~("variables":["x"],"potential":"x^2 + s")~", "/problem/potential", 6, "damping"},
      {R"~("variables":["x"],"lagrangian":"px^2/2")~", "/problem/lagrangian", 0, "knows velocities"},
      {R"~("variables":["x"],"hamiltonian":"vx^2/2")~", "/problem/hamiltonian", 0, "knows momenta"},
      {R"~("variables":["x"],"potential":"1+min(x)")~", "/problem/potential", 2, "is given 1 arguments"},
      {R"("variables":["x"],"potential":")" + deep + R"(")", "/problem/potential", 100, "nested"},
      {R"("variables":["x"],"potential":")" + long_text + R"(")", "/problem/potential", -2, "too long"},
      {R"("variables":["x"],"potential":")" + std::string(9999, '-') + R"(x")", "/problem/potential", -2, "nested"},
      {R"~("variables":["x","y"],"lagrangian":"(vx + vy)^2/2 - x*vx")~", "/problem/lagrangian", -1, "not regular"},
      {R"~("variables":["error"],"equations":{"error":"1"})~", "/problem/variables/0", -1, "already"},
      {R"~("variables":["x"],"potential":"x","invariants":{"mode":"px"})~", "/problem/invariants/mode", -1, "name"},
      {R"~("variables":["x"],"potential":"2x")~", "/problem/potential", 1, "product"},
      {R"~("variables":["x"],"potential":"x + é")~", "/problem/potential", 4, "ASCII"},
      {R"~("variables":["é"],"potential":"1")~", "/problem/variables/0", -1, "name"},
      {R"~("variables":["x"],"potential":"")~", "/problem/potential", 0, "empty"},
      {R"~("variables":["x"],"potential":"x^2","hamiltonian":"px^2")~", "/problem/potential", -1, "exclude"},
      {R"~("variables":["x"])~", "/problem", -1, "no mechanics"},
      {R"~("potential":"x^2")~", "/problem/variables", -1, "required"},
      {R"~("variables":[],"potential":"1")~", "/problem/variables", -1, "at least one"},
      {R"~("variables":["x"],"potential":"x^2","damping":"0.1","action_curvature":1)~", "/problem/damping", -1,
       "exclude"},
      {R"~("variables":["x"],"potential":"x^2","offset":1)~", "/problem/offset", -1, "action_curvature"},
      {R"~("variables":["x"],"lagrangian":"vx^2","masses":{"x":1})~", "/problem/masses", -1, "potential"},
      {R"~("variables":["x"],"potential":"x^2","invariants":{"x":"px"})~", "/problem/invariants/x", -1, "name"},
      {R"~("variables":["x"],"potential":"x^2","mu":3)~", "/problem/mu", -1, "unknown"},
  };
  for (const auto& row : rows) {
    const auto from = std::chrono::steady_clock::now();
    const auto reply = ask(port(), post("/v1/problems", R"({"problem":{"id":"custom",)" + row.problem + "}}"));
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - from;
    EXPECT_LT(took.count(), 1) << row.problem;  // 10 ms where nothing else is at work
    ASSERT_EQ(reply.status, 422) << row.problem << " " << reply.body;
    const Json fault = Json::parse(reply.body)["errors"][0];
    EXPECT_EQ(fault["pointer"], row.pointer) << fault;
    EXPECT_TRUE(says(fault, row.says)) << fault;
    if (row.position == -1) {
      EXPECT_FALSE(fault.contains("position")) << fault;
    } else if (row.position >= 0) {
      EXPECT_EQ(fault.value("position", -1), row.position) << fault;
    }
  }
}

// A fault points to what the request says: to a list where the list was given, to a step where no end was given.
TEST_F(CustomFaults, StandAtWhatTheRequestSays) {
  const struct {
    const char *request, *pointer, *says;
  } rows[] = {
      {R"~("problem":{"id":"custom","variables":["x[3]"],"potential":"x[1]^2","parameters":{"k":[1,-1,3]},
           "masses":{"x":"k"}})~",
       "/problem/masses/x", "not positive"},
      {R"~("problem":{"id":"custom","variables":["x[2]"],"potential":"x[1]^2","masses":{"x[2]":"-1"}})~",
       "/problem/masses/x[2]", "not positive"},
      {R"~("problem":{"id":"custom","variables":["x[2]"],"potential":"x[1]^2"},"initial":{"x":[5,6,7]})~", "/initial/x",
       "is a list of 3 numbers"},
      {R"~("problem":{"id":"custom","variables":["x"],"equations":"x"})~", "/problem/equations", "object of formulas"},
      {R"~("problem":"kepler","scheme":{"id":"leapfrog","step":1e-300})~", "/scheme/step", "more than can be counted"},
      {R"~("problem":"kepler","until":40,"scheme":{"id":"leapfrog","step":1e-300})~", "/until",
       "more than can be counted"},
  };
  for (const auto& row : rows) {
    std::string request = std::string("{") + row.request;
    if (request.find("scheme") == std::string::npos) request += R"(,"scheme":"taylor")";
    const Json fault = only_fault(ask(port(), post("/v1/simulate", request + "}")));
    EXPECT_EQ(fault["pointer"], row.pointer) << fault;
    EXPECT_TRUE(says(fault, row.says)) << fault;
  }
}

// Masses that couple hundreds of coordinates have an inverse too long to be printed, and the answer says that.
TEST_F(CustomFaults, EquationsThatAreTooLongAreNone) {
  const auto reply = ask(port(), post("/v1/problems", R"~({"problem":{"id":"custom","variables":["x[n]"],
      "parameters":{"n":300},
      "lagrangian":"sum(i=1..n,vx[i]^2/2)+0.3*sum(i=1..n-1,vx[i]*vx[i+1])-sum(i=1..n,x[i]^2/2)"}})~"));
  ASSERT_EQ(reply.status, 200) << reply.body;
  const Json card = Json::parse(reply.body);
  EXPECT_EQ(card["equations"]["x[1]"], "…");
  EXPECT_NE(card["equations_note"].get<std::string>().find("too many operations"), std::string::npos);
}

}  // namespace
}  // namespace least::server::test
