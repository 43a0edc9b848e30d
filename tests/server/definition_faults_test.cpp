// Definitions and lists of scenes as text that are refused, in words that say what is meant.
#include <gtest/gtest.h>

#include <string>

#include "tests/server/client.hpp"
#include "tests/server/faults.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

using DefinitionFaults = Serving;

TEST_F(DefinitionFaults, NameVelocitiesThatDefinitionsWouldHide) {
  const struct {
    const char *variable, *definition, *what;
  } rows[] = {{"x", "vx", "a velocity"},
              {"x", "px", "a momentum"},
              {"q", "v", "a velocity"},
              {"q[3]", "p", "a momentum"},
              {"th[2]", "vth", "a velocity"}};
  for (const auto& row : rows) {
    const std::string name = row.definition;
    const Json fault = only_fault(
        ask(port(), post("/v1/problems", std::string(R"({"problem":{"id":"custom","variables":[")") + row.variable +
                                             R"("],"potential":"1","definitions":{")" + name + R"(":"2"}}})")));
    EXPECT_EQ(fault["pointer"], "/problem/definitions/" + name);
    EXPECT_EQ(fault["detail"], name + " is something else already, " + row.what + ": it cannot be a definition, too");
  }
  EXPECT_EQ(ask(port(), post("/v1/problems", R"({"problem":{"id":"custom","variables":["x"],
      "definitions":{"vx":"2"},"equations":{"x":"-vx*x"}}})"))
                .status,
            200)
      << "equations have no velocities";
}

TEST_F(DefinitionFaults, NameDefinitionsThatUseThemselvesOrLaterOnes) {
  const auto fault_of = [&](const std::string& definitions) {
    const std::string begin = R"~({"problem":{"id":"custom","variables":["x"],"definitions":{)~";
    const Json fault =
        only_fault(ask(port(), post("/v1/problems", begin + definitions + R"~(},"potential":"x^2"}})~")));
    return fault["pointer"].get<std::string>() + ' ' + std::to_string(fault["position"].get<int>()) + ": " +
           fault["detail"].get<std::string>() + "; " + fault["allowed"].get<std::string>();
  };
  EXPECT_EQ(fault_of(R"~("f(i)":"x+f(i-1)")~"),
            "/problem/definitions/f(i) 2: f is this definition itself, and none may use itself; definitions above this "
            "one");
  EXPECT_EQ(fault_of(R"~("a":"b+x","b":"x")~"),
            "/problem/definitions/a 0: b is a definition further down; definitions above this one");
  EXPECT_EQ(ask(port(), post("/v1/problems", R"~({"problem":{"id":"custom","variables":["x"],
      "definitions":{"a":"sum(b=1..2,b*x)","c(d)":"d*x","b":"a","d":"c(1)"},"potential":"b^2+d^2"}})~"))
                .status,
            200)
      << "indices may have the names of later definitions";
}

TEST_F(DefinitionFaults, SayThatAListTakesNumbers) {
  const Json of_start = only_fault(ask(port(), post("/v1/simulate", R"({"problem":{"id":"custom","variables":["x[3]"],
      "potential":"x[1]^2"},"initial":{"x":1},"scheme":"leapfrog","until":1})")));
  EXPECT_EQ(of_start["pointer"], "/initial/x");
  EXPECT_EQ(of_start["detail"], "is a list and takes as many numbers as it has elements");
  EXPECT_EQ(of_start["allowed"], "3 numbers, or one of x[1] to x[3]");
  const Json of_list = only_fault(ask(port(), post("/v1/simulate", R"({"problem":{"id":"custom","variables":["x"],
      "parameters":{"l":[1,2,3]},"potential":"l[1]*x^2","l":3},"scheme":"leapfrog","until":1})")));
  EXPECT_EQ(of_list["pointer"], "/problem/l");
  EXPECT_EQ(of_list["allowed"], "3 numbers, or one of l[1] to l[3]");
}

}  // namespace
}  // namespace least::server::test
