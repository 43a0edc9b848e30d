// The discrete energy as a column, and what a hybrid's switches change, in answers: over real sockets.
#include <gtest/gtest.h>

#include "server/decode/json_parse.hpp"
#include "tests/server/client.hpp"
#include "tests/server/fixture.hpp"

namespace least::server::test {
namespace {

using DiscreteEnergyHttp = Serving;

Json with_discrete_energy(int port, const char* problem, const Json& scheme, const Json& until) {
  const Json request{{"problem", problem},
                     {"scheme", scheme},
                     {"until", until},
                     {"record", {{"every", 1}}},
                     {"columns", {"t", "energy", "discrete_energy"}}};
  const Reply reply = ask(port, post("/v1/simulate", request.dump()));
  EXPECT_EQ(reply.status, 200) << reply.body;
  return Json::parse(reply.body);
}

TEST_F(DiscreteEnergyHttp, IsAColumnAndNullWhereThereIsNone) {
  for (const auto& [problem, scheme, has] : {std::tuple{"kepler", "leapfrog", true},
                                             {"kepler", "runge_kutta_4", false},
                                             {"damped_oscillator", "contact_leapfrog", true},
                                             {"damped_oscillator", "contact_splitting", false}}) {
    const Json whole = with_discrete_energy(port(), problem, scheme, {{"steps", 3}});
    const Json& column = whole["trajectory"]["discrete_energy"];
    ASSERT_EQ(column.size(), 4U) << scheme;
    EXPECT_TRUE(column[0].is_null()) << scheme;
    for (std::size_t k = 1; k < 4; ++k) {
      ASSERT_EQ(column[k].is_number(), has) << scheme;
      if (has) {
        EXPECT_NEAR(column[k].get<double>(), whole["trajectory"]["energy"][k].get<double>(), 0.05) << scheme;
      }
    }
  }
}

TEST_F(DiscreteEnergyHttp, OfAHybridIsInItsEventsToo) {
  const Json whole =
      with_discrete_energy(port(), "kepler", {{"id", "jacobi_maupertuis"}, {"preset", "paper"}}, {{"t", 16}});
  std::size_t switches = 0;
  for (const Json& event : whole["events"]) {
    const bool is_switch = event["kind"] == "switch";
    switches += is_switch;
    for (const char* name : {"energy_jump", "discrete_energy_jump", "momentum_jumps"})
      EXPECT_EQ(event.contains(name), is_switch) << event;
    if (!is_switch) continue;
    EXPECT_TRUE(event["energy_jump"].is_number() && event["discrete_energy_jump"].is_number()) << event;
    EXPECT_TRUE(event["momentum_jumps"]["angular_momentum"].is_number()) << event;
  }
  EXPECT_EQ(switches, 2U);
}

}  // namespace
}  // namespace least::server::test
