// What POST /v1/problems says of problems of the catalogue: their form and their equations of motion, as of a scene
// that was typed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <regex>

#include "core/catalogue/catalogue.hpp"
#include "tests/server/client.hpp"
#include "tests/server/fixture.hpp"
#include "tests/support/runs.hpp"

namespace least::server::test {
namespace {

using CardEquations = Asking;

TEST_F(CardEquations, OfAnOscillatorAreThoseOfTextbooks) {
  runs::problem_called("harmonic_oscillator");
  const Json card = answer({{"problem", {{"id", "harmonic_oscillator"}, {"stiffness", 3}}}}, "/v1/problems");
  EXPECT_EQ(card["form"]["kind"], "separable");
  EXPECT_EQ(card["equations"]["q"], "p/mass");
  EXPECT_EQ(card["equations"]["p"], "-stiffness*q");
  EXPECT_FALSE(card.contains("text")) << "nobody wrote it as text";
}

// Of every problem of the catalogue they are said; typed as a scene they lead to the same end as the problem itself.
TEST_F(CardEquations, OfEveryProblemLeadToTheSameMotion) {
  std::size_t compared = 0;
  for (const ProblemCard& problem : runs::problem_cards()) {
    const Json card = answer({{"problem", problem.id}}, "/v1/problems");
    ASSERT_TRUE(card.contains("form")) << problem.id;
    ASSERT_TRUE(card.contains("equations")) << problem.id;
    Json scene{{"id", "custom"}, {"variables", Json::array()}, {"equations", Json::object()}};
    Json initial = Json::object();
    bool said = true;
    std::size_t left = card["equations"].size();
    for (const Json& variable : card["variables"]) {
      const std::string name = variable["name"];
      if (!card["equations"].contains(name)) said = said && variable["optional"].get<bool>();
      if (!card["equations"].contains(name)) continue;
      --left;
      if (card["equations"][name] == "…") said = false;  // too long
      if (name == "s") continue;                         // no variable of a flow can be called so
      if (std::regex_search(card["equations"][name].get<std::string>(), std::regex("\\bs\\b"))) said = false;
      scene["variables"].push_back(name);
      scene["equations"][name] = card["equations"][name];
      initial[name] = variable["default"];
    }
    // Said in velocities, or with the action; a motion that begins at a singularity.
    if (!said || left > 0 || problem.id == "lane_emden") continue;
    if (std::ranges::any_of(initial, [](const Json& value) { return value.is_null(); })) continue;
    for (const Json& parameter : card["parameters"])
      if (parameter["type"] == "number") {  // some are called as keys of a scene are
        const std::string name = parameter["name"], other = "own_" + name;
        scene["parameters"][other] = parameter["default"];
        for (auto& [of, rate] : scene["equations"].items())
          rate = std::regex_replace(rate.get<std::string>(), std::regex("\\b" + name + "\\b"), other);
      }
    const auto final = [&](const Json& of) {
      return answer({{"problem", of},
                     {"initial", initial},
                     {"scheme", "taylor"},
                     {"until", 1},
                     {"diagnostics", Json::array()},
                     {"record", {{"every", 0}}}})["final"];
    };
    const Json right = final(problem.id), typed = final(scene);
    ++compared;
    for (const auto& [name, value] : typed.items()) {
      if (!right.contains(name) || right[name].is_null()) continue;
      EXPECT_NEAR(value.get<double>(), right[name].get<double>(), 1e-9 * std::max(1.0, std::abs(value.get<double>())))
          << problem.id << ' ' << name;
    }
  }
  EXPECT_GT(5 * compared, runs::problem_cards().size());
}

}  // namespace
}  // namespace least::server::test
