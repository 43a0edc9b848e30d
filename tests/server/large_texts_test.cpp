// Texts that are short as typed and large when written out: they are refused by arithmetic, before anything is written,
// and all texts of a request share one bound.
#include <gtest/gtest.h>

#include <csignal>
#include <string>
#include <thread>
#include <vector>

#include "tests/server/client.hpp"
#include "tests/server/faults.hpp"
#include "tests/server/process.hpp"

namespace least::server::test {
namespace {

class LargeTexts : public testing::Test {
 protected:
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  static constexpr double most_seconds = 10;
#else
  static constexpr double most_seconds = 0.35;  // of the processor; 0.1 on a quiet machine
#endif

  int port() const { return port_in(line_); }

  /// refused returns the reply to a request that takes little processor time in at least one of three attempts.
  Reply refused(const std::string& path, const std::string& body) {
    Reply reply;
    const double least = service_.least_seconds(most_seconds, [&] { reply = ask(port(), post(path, body)); });
    EXPECT_LT(least, most_seconds) << body.substr(0, 200);
    EXPECT_EQ(reply.status, 422) << body.substr(0, 200) << reply.body.substr(0, 300);
    return reply;
  }
  /// first_fault returns the pointer and the detail of the first fault.
  static std::string first_fault(const Reply& reply) {
    const Json document = Json::parse(reply.body);
    const Json& error = document.at("errors").at(0);
    return error.at("pointer").get<std::string>() + ": " + error.at("detail").get<std::string>();
  }
  static std::string scene(const std::string& members) { return R"~({"problem":{"id":"custom",)~" + members + "}}"; }

  Process service_{{"serve", "--port", "0", "--threads", "2", "--grace", "0.2", "--log-level", "off"}};
  const std::string line_ = service_.line();
};

/// chain returns definitions d0, d1, …, each of which is made of the one above.
std::string chain(const std::string& first, const std::string& before, const std::string& after, int count,
                  const std::string& index = {}) {
  std::string all = R"~("d0)~" + index + R"~(":")~" + first + '"';
  for (int i = 1; i < count; ++i) {
    const std::string above = "d" + std::to_string(i - 1);
    all += ",\"d" + std::to_string(i) + index + "\":\"" + above + before + above + after + '"';
  }
  return all;
}

constexpr const char* too_large = "takes too many operations when it is written out";

// Each of these took from half a second to forever.
TEST_F(LargeTexts, OfASceneAreRefusedAtOnce) {
  const std::string ten = R"~("variables":["q[10]"],"potential":)~";
  const std::string one = R"~("variables":["x","a","b"],"definitions":{)~";
  const struct {
    std::string scene, pointer, detail;
  } rows[] = {{ten + R"~("q[1]^2+sum(i=1..10000000,j=i+1..i,q[1])")~", "/problem/potential", too_large},
              {ten + R"~("q[1]^2+sum(i=1..1000000000,j=i+1..i,q[1])")~", "/problem/potential", too_large},
              {one + chain("a+b", "*", "", 560) + R"~(},"potential":"a^2")~", "/problem/definitions/d17", too_large},
              {one + chain("x", "+", "*x", 60) + R"~(},"potential":"d59")~", "/problem/definitions/d17", too_large},
              {one + chain("x*k", "(k)+", "(k+1)", 60, "(k)") + R"~(},"potential":"d59(1)")~",
               "/problem/definitions/d17(k)", too_large},
              {R"~("variables":["q[2048]"],"equations":{"q[i]":"sum(j=1..2048,foo(q[i]-q[j]))"})~",
               "/problem/equations/q[i]", "takes too many operations"},
              {R"~("variables":["q[2048]"],"equations":{"q[i]":"sum(j=i..2048,q[i]*q[j])"})~",
               "/problem/equations/q[i]", "takes too many operations"},
              {R"~("variables":["x[1000]"],"definitions":{"f(i)":"sum(j=1..1000,sin(x[i]-x[j]))"},)~"
               R"~("equations":{"x[i]":"f(i)+f(mod(i,1000)+1)"})~",
               "/problem/equations/x[i]", "takes too many operations"},
              {R"~("variables":["x"],"potential":"sum(a=1..100000,b=1..100000,if(a==b and a==1,x^2,0))")~",
               "/problem/potential", too_large},
              {R"~("variables":["x"],"definitions":{"f(i)":"sum(j=1..100000,x)"},"potential":"sum(i=1..100000,f(i))")~",
               "/problem/potential", too_large}};
  for (const auto& row : rows)
    EXPECT_EQ(first_fault(refused("/v1/problems", scene(row.scene))), row.pointer + ": " + row.detail) << row.scene;
}

// What is not taken of a long condition, or summed in a long empty sum, is passed over term by term.
TEST_F(LargeTexts, ThatArePassedOverCountToo) {
  std::string sum = "x";
  for (int i = 0; i < 4500; ++i) sum += "+x";
  EXPECT_EQ(
      first_fault(refused("/v1/problems",
                          scene(R"~("variables":["x"],"potential":"x^2+sum(i=1..150000,j=i+1..i,)~" + sum + ")\""))),
      std::string("/problem/potential: ") + too_large);
  EXPECT_EQ(
      first_fault(refused("/v1/problems",
                          scene(R"~("variables":["y[2000]","x"],"equations":{"x":"1","y[i]":"sum(j=1..64,if(j==0,)~" +
                                sum + ",0))\"}"))),
      std::string("/problem/equations/y[i]: ") + too_large);
}

// Columns, acts and the scene's own texts: many of them take no more than one.
TEST_F(LargeTexts, BesideASceneAreBoundedTogether) {
  const std::string begin = R"~({"problem":{"id":"custom","variables":["q[500]"],"potential":"sum(i=1..500,q[i]^2)"},
      "scheme":"leapfrog","until":1,)~";
  for (const char* large : {"q[1]+sum(i=1..500,j=1..190,q[i]*q[j])", "sum(i=1..500,j=i+1..500,q[i]*q[j])",
                            "sum(i=1..150,j=1..150,if(i<j+500,q[i]*j,0))"}) {
    std::string columns, set;
    for (int i = 1; i <= 100; ++i) {
      columns += (i > 1 ? "," : "") + ("{\"name\":\"c" + std::to_string(i)) + R"~(","expression":")~" + large + "\"}";
      set += (i > 1 ? ",\"q[" : "\"q[") + std::to_string(i) + "]\":\"" + large + '"';
    }
    EXPECT_EQ(first_fault(refused("/v1/simulate", begin + R"~("columns":[)~" + columns + "]}")).substr(0, 9),
              "/columns/");
    EXPECT_EQ(first_fault(refused("/v1/simulate",
                                  begin + R"~("events":[{"name":"e","expression":"q[1]-1","set":{)~" + set + "}}]}"))
                  .substr(0, 14),
              "/events/0/set/");
  }
}

TEST_F(LargeTexts, AreWrittenOutInColumnsAsInTheMechanics) {
  const Reply reply =
      ask(port(), post("/v1/simulate", R"~({"problem":{"id":"custom","variables":["x[n]"],"parameters":{"n":60},
        "definitions":{"d(i,j)":"sqrt((x[i]-x[j])^2+1)"},"potential":"sum(i=1..n,j=i+1..n,1/d(i,j))"},
        "scheme":"leapfrog","until":1,"columns":[{"name":"c","expression":"sum(i=1..n,j=i+1..n,1/d(i,j))"}],
        "events":[{"name":"e","expression":"sum(i=1..n,j=i+1..n,1/d(i,j))-1e9"}],"record":{"every":0}})~"));
  EXPECT_EQ(reply.status, 200) << reply.body.substr(0, 300);
}

}  // namespace
}  // namespace least::server::test
