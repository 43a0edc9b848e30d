// Abandoned requests: clients that go away while their answer is computed, or while they read it.
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "tests/server/client.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

using Abandoned = OnePlace;

struct LongRequest {
  const char* name;
  std::string bytes;
};
void PrintTo(const LongRequest& request, std::ostream* out) { *out << request.name; }

constexpr const char* as_table = "Accept: text/csv\r\n";
constexpr const char* as_lines = "Accept: application/x-ndjson\r\n";
constexpr const char* fixed_steps =
    R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":10000000000},"record":{"every":0},
        "limits":{"steps":10000000000,"seconds":20}})";
constexpr const char* own_clock =
    R"({"problem":"kepler","scheme":"time_transformed","until":{"t":1e9},"record":{"every":0},
        "limits":{"steps":10000000000,"seconds":20}})";
constexpr const char* automatic =
    R"({"problem":"kepler","scheme":{"id":"auto","accuracy":1e-13},"until":{"t":4000},"limits":{"seconds":20}})";
constexpr const char* work_precision =
    R"({"problem":"kepler","until":{"t":400},"schemes":"all","error":"max","budget_seconds":20})";
constexpr const char* closed_orbit = R"({"problem":"kepler","period":1e9,"limits":{"seconds":20}})";
std::string stability() {
  constexpr const char* slow = R"({"id":"galerkin_4","composition":"kahan_li_8"})";
  std::string schemes = slow;
  for (int i = 1; i < 100; ++i) schemes.append(",").append(slow);
  return R"({"problem":"double_pendulum","schemes":[)" + schemes + R"(],"budget_seconds":20})";
}

class AbandonedWhile : public Abandoned, public testing::WithParamInterface<LongRequest> {};

TEST_P(AbandonedWhile, ItIsComputedFreesItsPlaceSoon) {
  start();
  {
    Client client(service->port());
    client.send(GetParam().bytes);
    std::this_thread::sleep_for(400ms);
    EXPECT_EQ(run(), 503) << "it computes";
  }
  EXPECT_TRUE(is_free_soon());
}

INSTANTIATE_TEST_SUITE_P(All, AbandonedWhile,
                         testing::Values(LongRequest{"simulate", post("/v1/simulate", fixed_steps)},
                                         LongRequest{"simulate_csv", post("/v1/simulate", fixed_steps, as_table)},
                                         LongRequest{"own_clock", post("/v1/simulate", own_clock)},
                                         LongRequest{"automatic", post("/v1/simulate", automatic)},
                                         LongRequest{"work_precision", post("/v1/work-precision", work_precision)},
                                         LongRequest{"lines", post("/v1/work-precision", work_precision, as_lines)},
                                         LongRequest{"closed_orbit", post("/v1/periodic", closed_orbit)},
                                         LongRequest{"members", post("/v1/periodic", closed_orbit, as_lines)},
                                         LongRequest{"stability", post("/v1/stability", stability())}),
                         [](const auto& row) { return std::string(row.param.name); });

TEST_F(Abandoned, BetweenTheLinesOfAnAnswer) {
  start();
  {
    Client client(service->port());
    client.send(post("/v1/work-precision", work_precision, as_lines));
    ASSERT_EQ(client.interim(), 200);  // the head
    for (int line = 0; line < 3; ++line) EXPECT_FALSE(client.chunk().value_or("").empty());
    EXPECT_EQ(run(), 503) << "it computes";
  }
  EXPECT_TRUE(is_free_soon());
}

// The first lines of a run arrive long before its end: its place is still taken then.
TEST_F(Abandoned, LinesLeaveWhileItComputes) {
  start();
  std::string request = fixed_steps;
  request.replace(request.find("\"every\":0"), 9, "\"every\":1000000");
  {
    Client client(service->port());
    client.send(post("/v1/simulate", request, as_lines));
    ASSERT_EQ(client.interim(), 200);
    for (const char* kind : {R"({"kind":"head")", R"({"kind":"samples")", R"({"kind":"progress")"}) {
      std::string line = client.chunk().value_or("");
      if (kind[9] == 'p') {
        while (line.starts_with(R"({"kind":"samples")")) line = client.chunk().value_or("");
      }
      EXPECT_TRUE(line.starts_with(kind)) << line.substr(0, 100);
      EXPECT_EQ(run(), 503) << "it computes when there is " << kind;
    }
  }
  EXPECT_TRUE(is_free_soon());
}

// Tens of megabytes, of which a client takes the beginning: the only connection is free for the next client at once.
TEST_F(Abandoned, InTheMiddleOfALargeAnswer) {
  settings.connections = 1;
  settings.bounds.stall = 20s;
  start();
  for (const char* accept : {"", as_table}) {
    {
      Client client(service->port());
      client.send(post("/v1/simulate",
                       R"({"problem":"kepler","scheme":"leapfrog","until":{"steps":200000},"record":{"every":1}})",
                       accept));
      EXPECT_EQ(client.interim(), 200);
      EXPECT_TRUE(client.some());
    }
    const auto from = Clock::now();
    EXPECT_EQ(run(), 200);
    EXPECT_LT(Clock::now() - from, 15s);
  }
}

}  // namespace
}  // namespace least::server::test
