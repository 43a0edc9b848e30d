// The discrete energy as a column, and its jumps where a hybrid switches, in answers over real sockets.
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

// A scene as text, of any size, has the discrete energy of the problem that it describes, forward and backward.
TEST_F(DiscreteEnergyHttp, OfAScenesAsTextIsThatOfTheProblem) {
  const Json conservative = Json::parse(R"({"id":"custom","variables":["q"],"potential":"q^2/2"})");
  Json damped = conservative;
  damped["damping"] = "0.1";
  for (const char* composition : {"none", "suzuki_4"})
    for (const auto& [problem, scene, id] :
         {std::tuple{Json("harmonic_oscillator"), conservative, "leapfrog"},
          {Json("harmonic_oscillator"), conservative, "symplectic_euler"},
          {Json{{"id", "damped_oscillator"}, {"stiffness", 1}, {"damping", 0.1}}, damped, "contact_leapfrog"}}) {
      Json scheme{{"id", id}, {"step", 0.1}};
      if (std::string_view(id) != "symplectic_euler") scheme["composition"] = composition;
      const auto energies = [&](const Json& of, double until) {
        const Json request{{"problem", of},
                           {"initial", {{"q", 0.7}, {"p", 0.4}}},
                           {"scheme", scheme},
                           {"until", until},
                           {"record", {{"every", 1}}},
                           {"columns", {"discrete_energy"}}};
        const Reply reply = ask(port(), post("/v1/simulate", request.dump()));
        EXPECT_EQ(reply.status, 200) << reply.body;
        return Json::parse(reply.body)["trajectory"]["discrete_energy"];
      };
      Json as_text = scene;
      const Json compiled = energies(problem, 1), typed = energies(as_text, 1), back = energies(as_text, -1);
      ASSERT_EQ(compiled.size(), 11U);
      for (std::size_t k = 1; k < 11; ++k) {
        EXPECT_NEAR(typed[k].get<double>(), compiled[k].get<double>(), 1e-13) << id << composition;
        EXPECT_TRUE(back[k].is_number()) << id << composition;
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
